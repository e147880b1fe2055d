// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/ray_path.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace cairn {
namespace {

struct RowRun {
  std::int64_t row, first, last;
  friend bool operator==(const RowRun&, const RowRun&) = default;
};

std::vector<RowRun> runs(GridPoint a, GridPoint b) {
  std::vector<RowRun> runs;
  for_each_run(a, b, [&](std::int64_t row, std::int64_t first, std::int64_t last) {
    runs.push_back({row, first, last});
  });
  return runs;
}

// Does the line run through the inside of the cell? Liang and Barsky, in whole numbers: the part of
// the line in the cell is [enter, leave] / scale.
bool crosses(GridPoint a, GridPoint b, std::int64_t column, std::int64_t row) {
  using Wide = __int128;
  const Wide dx = b.x - a.x, dy = b.y - a.y;
  const Wide scale = (dx == 0 ? 1 : (dx < 0 ? -dx : dx)) * (dy == 0 ? 1 : (dy < 0 ? -dy : dy));
  Wide enter = 0, leave = scale;
  const auto cut = [&](Wide start, Wide d, Wide low, Wide high) {
    if (d == 0) return start > low && start < high;
    const Wide to_low = (low - start) * (scale / d), to_high = (high - start) * (scale / d);
    enter = std::max(enter, std::min(to_low, to_high));
    leave = std::min(leave, std::max(to_low, to_high));
    return true;
  };
  return cut(a.x, dx, column * kSubcells, (column + 1) * kSubcells) &&
         cut(a.y, dy, row * kSubcells, (row + 1) * kSubcells) && enter < leave;
}

TEST(RayPath, GoesAlongARowAtOnce) {
  EXPECT_EQ(runs({10, 10}, {1000, 20}), (std::vector<RowRun>{{0, 0, 3}}));
  EXPECT_EQ(runs({1000, 20}, {10, 10}), (std::vector<RowRun>{{0, 0, 3}}));
}

TEST(RayPath, IsOneCellWhereItEndsInTheCellOfItsStart) {
  EXPECT_EQ(runs({-1, -1}, {-256, -256}), (std::vector<RowRun>{{-1, -1, -1}}));
}

TEST(RayPath, MeetsEveryCellThatTheLineRunsThroughAndHasNoGaps) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> coordinate(-5000, 5000);
  for (int i = 0; i < 2000; ++i) {
    const GridPoint a{coordinate(random), coordinate(random)};
    const GridPoint b{coordinate(random), coordinate(random)};
    const std::vector<RowRun> path = runs(a, b);
    const std::int64_t low = std::min(cell_of(a.y), cell_of(b.y));
    ASSERT_EQ(std::ssize(path), std::abs(cell_of(a.y) - cell_of(b.y)) + 1);
    for (std::size_t k = 0; k < path.size(); ++k) {
      ASSERT_EQ(path[k].row, low + static_cast<std::int64_t>(k));
      if (k > 0) {
        ASSERT_TRUE(path[k].first == path[k - 1].last || path[k].last == path[k - 1].first);
      }
      for (std::int64_t column = path[k].first - 2; column <= path[k].last + 2; ++column) {
        const bool inside = column >= path[k].first && column <= path[k].last;
        if (crosses(a, b, column, path[k].row)) {
          ASSERT_TRUE(inside) << i;
        } else if (inside && path[k].first != path[k].last) {
          // What is in and not run through is touched: it is beside one that is run through.
          ASSERT_TRUE(crosses(a, b, column - 1, path[k].row) ||
                      crosses(a, b, column + 1, path[k].row))
              << i;
        }
      }
    }
  }
}

TEST(RayPath, IsTheSameBothWays) {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::int64_t> coordinate(-100'000, 100'000);
  for (int i = 0; i < 1000; ++i) {
    const GridPoint a{coordinate(random), coordinate(random)};
    const GridPoint b{coordinate(random), coordinate(random) + 200'001};
    EXPECT_EQ(runs(a, b), runs(b, a));
  }
}

}  // namespace
}  // namespace cairn
