// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/correlative.hpp"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

struct Candidate {
  int angle;        ///< index
  int column, row;  ///< smallest offset of the square, in cells
  int level;
  double score = 0.0;  ///< bound (level 0: value), 0 .. 255 per echo, summed
};

// The cells of a scan's echoes at one angle, at the start's position.
struct TurnedScan {
  std::vector<int> columns, rows;
};

}  // namespace

LikelihoodGrid::LikelihoodGrid(const std::vector<SurfacePoint>& points, const Options& options)
    : options_(options), origin_(Eigen::Vector2d::Zero()) {
  levels_.resize(static_cast<std::size_t>(options.levels));
  if (points.empty()) return;
  Eigen::Vector2d low = points.front().position, high = low;
  for (const SurfacePoint& point : points) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const int around = static_cast<int>(std::ceil(3.0 * options.sigma_m / options.cell_m));
  const int margin = around + (1 << options.levels);
  origin_ = low - Eigen::Vector2d::Constant(margin * options.cell_m);
  columns_ = static_cast<int>((high.x() - low.x()) / options.cell_m) + 2 * margin + 1;
  rows_ = static_cast<int>((high.y() - low.y()) / options.cell_m) + 2 * margin + 1;
  const auto size = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<std::uint8_t>& fine = levels_[0];
  fine.assign(size, 0);
  std::vector<std::uint8_t> stamp;
  for (int y = -around; y <= around; ++y)
    for (int x = -around; x <= around; ++x)
      stamp.push_back(static_cast<std::uint8_t>(
          std::lround(255.0 * std::exp(-0.5 * (x * x + y * y) * options.cell_m * options.cell_m /
                                       (options.sigma_m * options.sigma_m)))));
  for (const SurfacePoint& point : points) {
    const Eigen::Vector2d cell = (point.position - origin_) / options.cell_m;
    const int c = static_cast<int>(cell.x()), r = static_cast<int>(cell.y());
    std::size_t k = 0;
    for (int y = r - around; y <= r + around; ++y)
      for (int x = c - around; x <= c + around; ++x, ++k) {
        std::uint8_t& value =
            fine[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(x)];
        value = std::max(value, stamp[k]);
      }
  }
  // Each level from the one below: the maximum over twice as many cells to the right and up.
  for (int level = 1; level < options.levels; ++level) {
    const std::vector<std::uint8_t>& below = levels_[static_cast<std::size_t>(level) - 1];
    std::vector<std::uint8_t>& here = levels_[static_cast<std::size_t>(level)];
    here.resize(size);
    const int half = 1 << (level - 1);
    const auto value = [&](int c, int r) -> std::uint8_t {
      return c < columns_ && r < rows_
                 ? below[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(c)]
                 : 0;
    };
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        here[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
             static_cast<std::size_t>(c)] =
            std::max(std::max(value(c, r), value(c + half, r)),
                     std::max(value(c, r + half), value(c + half, r + half)));
  }
}

std::optional<CorrelativeMatch> match_correlative(const LikelihoodGrid& grid,
                                                  const std::vector<SurfacePoint>& scan,
                                                  const Se2& start, const SearchWindow& window,
                                                  double least_score, std::int64_t most_lookups) {
  if (scan.empty()) return std::nullopt;
  double farthest = 0.0;
  for (const SurfacePoint& point : scan) farthest = std::max(farthest, point.position.norm());
  const double cell = grid.cell_m();
  // One step moves the farthest echo by one cell at most.
  const double angle_step = 2.0 * std::asin(std::min(1.0, 0.5 * cell / std::max(farthest, cell)));
  const int turns = static_cast<int>(std::ceil(window.angle_rad / angle_step));
  const int half_x = static_cast<int>(std::ceil(window.x_m / cell));
  const int half_y = static_cast<int>(std::ceil(window.y_m / cell));
  std::vector<TurnedScan> turned(static_cast<std::size_t>(2 * turns + 1));
  for (int k = -turns; k <= turns; ++k) {
    const So2 R(start.rotation().angle() + k * angle_step);
    TurnedScan& cells = turned[static_cast<std::size_t>(k + turns)];
    for (const SurfacePoint& point : scan) {
      const Eigen::Vector2d p = (R * point.position + start.translation() - grid.origin()) / cell;
      cells.columns.push_back(static_cast<int>(std::floor(p.x())));
      cells.rows.push_back(static_cast<int>(std::floor(p.y())));
    }
  }
  CorrelativeMatch best;
  const auto evaluate = [&](Candidate& candidate) {
    const TurnedScan& cells = turned[static_cast<std::size_t>(candidate.angle)];
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < cells.columns.size(); ++i)
      sum += grid.at(candidate.level, cells.columns[i] + candidate.column,
                     cells.rows[i] + candidate.row);
    best.lookups += static_cast<std::int64_t>(cells.columns.size());
    candidate.score = static_cast<double>(sum);
  };
  const auto better = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
  const int top =
      std::min(grid.levels() - 1, static_cast<int>(std::log2(std::max({1, half_x, half_y}))) + 1);
  std::vector<Candidate> roots;
  for (int k = 0; k < 2 * turns + 1; ++k)
    for (int y = -half_y; y <= half_y; y += 1 << top)
      for (int x = -half_x; x <= half_x; x += 1 << top) {
        roots.push_back({k, x, y, top});
        evaluate(roots.back());
      }
  std::stable_sort(roots.begin(), roots.end(), better);
  const double full = 255.0 * static_cast<double>(scan.size());
  double least = least_score * full;
  std::optional<Candidate> found;
  bool exhausted = false;
  const auto descend = [&](const auto& self, const Candidate& parent) -> void {
    if (exhausted || parent.score <= least) return;
    if (parent.level == 0) {
      least = parent.score;
      found = parent;
      return;
    }
    if (best.lookups > most_lookups) {
      exhausted = true;
      return;
    }
    std::vector<Candidate> children;
    const int half = 1 << (parent.level - 1);
    for (const int dy : {0, half})
      for (const int dx : {0, half}) {
        Candidate child{parent.angle, parent.column + dx, parent.row + dy, parent.level - 1};
        if (child.column > half_x || child.row > half_y) continue;
        evaluate(child);
        children.push_back(child);
      }
    std::stable_sort(children.begin(), children.end(), better);
    for (const Candidate& child : children) self(self, child);
  };
  for (const Candidate& root : roots) {
    if (root.score <= least || exhausted) break;
    descend(descend, root);
  }
  if (!found || exhausted) return std::nullopt;
  best.score = found->score / full;
  best.T_map_scan = Se2(So2(start.rotation().angle() + (found->angle - turns) * angle_step),
                        start.translation() + cell * Eigen::Vector2d(found->column, found->row));
  return best;
}

}  // namespace cairn
