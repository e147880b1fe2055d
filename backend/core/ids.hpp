// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace cairn {

/// An integer that names one kind of thing and does not convert to another kind.
template <class Tag, class Integer>
struct StrongId {
  Integer value{};
  friend constexpr auto operator<=>(StrongId, StrongId) = default;
};

/// Names a variable; what a graph file calls the vertex id. 64 bits, sparse (multi-robot files keep
/// the robot in the top byte).
using VariableId = StrongId<struct VariableIdTag, std::uint64_t>;
/// Names a sensor offset; what g2o calls the parameter id. A number space of its own.
using ParameterId = StrongId<struct ParameterIdTag, std::int64_t>;

}  // namespace cairn

template <class Tag, class Integer>
struct std::hash<cairn::StrongId<Tag, Integer>> {
  std::size_t operator()(cairn::StrongId<Tag, Integer> id) const noexcept {
    // Fibonacci hashing. The upper half of the product depends on every bit, the robot in the top
    // byte included.
    std::uint64_t x = static_cast<std::uint64_t>(id.value);
    x ^= x >> 32;
    return static_cast<std::size_t>(x * 0x9E3779B97F4A7C15ULL >> 32);
  }
};
