// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>

#include "cairn/maps/grid_index.hpp"

namespace cairn {

/// A quotient that is rounded down, and its remainder (never negative); `divisor` > 0.
struct FloorDivision {
  std::int64_t quotient, remainder;

  FloorDivision(std::int64_t dividend, std::int64_t divisor)
      : quotient(dividend / divisor), remainder(dividend % divisor) {
    if (remainder < 0) {
      remainder += divisor;
      --quotient;
    }
  }
};

/// Where a ray goes: calls visit(row, first, last) with the columns of the cells that the straight
/// line from a to b runs through, for each row once, upwards. In whole numbers only: nothing is
/// rounded but the two ends. Where the line crosses a corner, one of the cells beside it is in too.
/// The ends must be within 2^27 cells of each other.
template <class Visit>
void for_each_run(GridPoint a, GridPoint b, const Visit& visit) {
  if (a.y > b.y) std::swap(a, b);
  const std::int64_t dx = b.x - a.x, dy = b.y - a.y, last_row = cell_of(b.y);
  std::int64_t row = cell_of(a.y), column = cell_of(a.x);
  const auto run_to = [&](std::int64_t next) {
    visit(row, std::min(column, next), std::max(column, next));
    column = next;
  };
  if (row < last_row) {
    // Where the line crosses into the next row: x = a.x + crossing / dy, exactly.
    FloorDivision crossing(((row + 1) * kSubcells - a.y) * dx, dy);
    const FloorDivision step(kSubcells * dx, dy);
    std::int64_t x = a.x + crossing.quotient, remainder = crossing.remainder;
    for (; row < last_row; ++row) {
      run_to(cell_of(x));
      remainder += step.remainder;
      const std::int64_t carry = remainder >= dy ? 1 : 0;
      x += step.quotient + carry;
      remainder -= carry * dy;
    }
  }
  run_to(cell_of(b.x));
}

}  // namespace cairn
