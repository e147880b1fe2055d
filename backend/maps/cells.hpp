// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "cairn/maps/laser_cells.hpp"
#include "cairn/maps/sonar_cells.hpp"

namespace cairn {

/// How a cell keeps what scans said of it. Whole numbers that are only ever added up, and limited
/// when they are read: the order of scans takes no part, and what was added can be taken away.

/// From how many scans an echo came from the cell, and how many saw through it.
struct HitMissCell {
  std::uint32_t hits = 0, misses = 0;

  friend bool operator==(const HitMissCell&, const HitMissCell&) = default;
};

/// The sum of log(p / (1 - p)) of all scans, in thousandths.
struct LogOddsCell {
  std::int32_t log_odds = 0;

  friend bool operator==(const LogOddsCell&, const LogOddsCell&) = default;
};

enum class Sign : std::int8_t { kAdd = 1, kTakeAway = -1 };

namespace detail {

// Calls change(cell) for the cells of a row that have their bit set.
template <class Cell, class Change>
void change_row(Cell* row, std::uint64_t bits, const Change& change) {
  if (bits == ~std::uint64_t{0}) {
    for (int i = 0; i < kTileCells; ++i) change(row[i]);
    return;
  }
  for (; bits != 0; bits &= bits - 1) change(row[std::countr_zero(bits)]);
}

}  // namespace detail

/// Adds what a scan says of a tile to its cells, or takes it away again.
inline void apply(const LaserEvidence& evidence, Sign sign,
                  std::array<HitMissCell, kTileArea>& cells) {
  const auto one = static_cast<std::uint32_t>(sign);  // modulo 2^32
  for (int row = 0; row < kTileCells; ++row) {
    HitMissCell* first = cells.data() + row * kTileCells;
    detail::change_row(first, evidence.misses[row], [&](HitMissCell& cell) { cell.misses += one; });
    detail::change_row(first, evidence.hits[row], [&](HitMissCell& cell) { cell.hits += one; });
  }
}

inline void apply(const SonarEvidence& evidence, Sign sign,
                  std::array<LogOddsCell, kTileArea>& cells) {
  const auto one = static_cast<std::int32_t>(sign);
  for (std::size_t i = 0; i < kTileArea; ++i) cells[i].log_odds += one * evidence.log_odds[i];
}

}  // namespace cairn
