// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/thinning.hpp"

#include <tsl/robin_map.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace cairn::drawing {
namespace {

struct CellPair {
  std::uint64_t a, b;
  bool operator==(const CellPair&) const = default;
};

struct CellPairHash {
  std::size_t operator()(const CellPair& pair) const {
    std::uint64_t x =
        pair.a * 0x9E3779B97F4A7C15ULL ^ (pair.b + 0x7F4A7C15ULL) * 0xC2B2AE3D27D4EB4FULL;
    return static_cast<std::size_t>(x ^ x >> 29);
  }
};

std::uint64_t cell_of(const Point& point, double cell) {
  const auto column = static_cast<std::uint32_t>(std::lround(point.x() / cell));
  const auto row = static_cast<std::uint32_t>(std::lround(point.y() / cell));
  return static_cast<std::uint64_t>(row) << 32 | column;
}

CellPair cells_of(const Segment& line, double cell) {
  const std::uint64_t a = cell_of(line.a, cell), b = cell_of(line.b, cell);
  return a < b ? CellPair{a, b} : CellPair{b, a};
}

std::vector<Stroke> uncovered(const std::vector<Stroke>& strokes, double cell) {
  tsl::robin_map<CellPair, std::size_t, CellPairHash>
      keeper;  // the stroke of the highest layer between two cells
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const auto [found, is_new] = keeper.try_emplace(cells_of(strokes[i].line, cell), i);
    if (!is_new && strokes[i].layer > strokes[found->second].layer) found.value() = i;
  }
  std::vector<Stroke> kept;
  kept.reserve(keeper.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (keeper.find(cells_of(strokes[i].line, cell))->second == i) kept.push_back(strokes[i]);
  }
  return kept;
}

}  // namespace

std::vector<Stroke> joined_steps(const std::vector<Stroke>& strokes, double step) {
  std::vector<Stroke> joined;
  for (const Stroke& stroke : strokes) {
    const bool short_step =
        !joined.empty() && (joined.back().line.b - joined.back().line.a).norm() < step;
    if (short_step) {
      joined.back().line.b = stroke.line.b;
    } else {
      joined.push_back(stroke);
    }
  }
  return joined;
}

void drop_covered(std::vector<Stroke>& strokes, double cell, std::size_t budget) {
  constexpr double kGrowth = 1.4;
  strokes = uncovered(strokes, cell);
  while (strokes.size() > budget) {
    cell *= kGrowth;
    strokes = uncovered(strokes, cell);
  }
}

}  // namespace cairn::drawing
