// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "cairn/graph/transaction.hpp"

namespace cairn::test {

/// The n-th transaction of a robot that drives: one pose, one odometry factor, now and then a loop,
/// a payload and an edit. About 600 bytes when encoded. The same for the same n.
inline Transaction some_transaction(std::uint64_t n) {
  const auto node = [](std::uint64_t index) { return NodeId{{"robot-1", 77}, index}; };
  const double x = 0.5 * static_cast<double>(n);
  Transaction t{.key = {"robot-1/laser", 0xABCDEF, n},
                .sent_ns = static_cast<std::int64_t>(n) * 1000,
                .variables = {},
                .factors = {},
                .edits = {}};
  t.variables.push_back({node(n),
                         VariableType::kPose3,
                         {x, -x, 0.0, 0.0, 0.0, 0.0, 1.0},
                         static_cast<std::int64_t>(n) * 100'000'000,
                         {x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}});
  std::vector<double> numbers(28, 0.25);
  numbers[0] = x;
  t.factors.push_back({FactorType{2}, FactorKind::kOdometry, {node(n - 1), node(n)}, numbers});
  if (n % 10 == 3) {
    t.factors.push_back({FactorType{2}, FactorKind::kLoop, {node(n / 2), node(n)}, numbers});
    t.factors.back().payloads.push_back(content_hash(t.key.source));
  }
  if (n % 25 == 4)
    t.edits.push_back({{{"robot-1/laser", 0xABCDEF, n - 1}, 1}, FactorChange::kDisable});
  return t;
}

}  // namespace cairn::test
