// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace cairn {

/// Who was where: for each cell of a lattice, the poses that visited it, newest first.
class Visits {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  Visits(std::size_t cells, std::size_t poses) : newest_(cells, kNone) { older_.reserve(poses); }

  [[nodiscard]] std::uint32_t newest(std::size_t cell) const { return newest_[cell]; }
  /// The visit to the same cell before this one, or kNone.
  [[nodiscard]] std::uint32_t older(std::uint32_t pose) const { return older_[pose]; }
  /// Poses are added in order: 0, 1, 2, ...
  void add(std::size_t cell) {
    older_.push_back(newest_[cell]);
    newest_[cell] = static_cast<std::uint32_t>(older_.size() - 1);
  }

 private:
  std::vector<std::uint32_t> newest_;
  std::vector<std::uint32_t> older_;
};

}  // namespace cairn
