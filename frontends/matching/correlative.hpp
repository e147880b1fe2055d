// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frontends/matching/scan_points.hpp"

namespace cairn {

/// How likely an echo is at each place of a map: 255 on a surface, falling off like a Gaussian.
/// Levels: level k holds the maximum over squares of 2^k cells from the cell on, for bounds.
class LikelihoodGrid {
 public:
  struct Options {
    double cell_m = 0.05, sigma_m = 0.06;
    int levels = 6;
  };
  LikelihoodGrid(const std::vector<SurfacePoint>& points, const Options& options);

  [[nodiscard]] double cell_m() const { return options_.cell_m; }
  [[nodiscard]] int levels() const { return options_.levels; }
  /// Of the cell at a place in cells from the origin; 0 outside.
  [[nodiscard]] int at(int level, int column, int row) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return 0;
    return levels_[static_cast<std::size_t>(level)]
                  [static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(column)];
  }
  [[nodiscard]] const Eigen::Vector2d& origin() const { return origin_; }

 private:
  Options options_;
  Eigen::Vector2d origin_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::uint8_t>> levels_;
};

struct SearchWindow {
  double x_m = 1.0, y_m = 1.0, angle_rad = 0.35;  ///< to both sides of the start
};

struct CorrelativeMatch {
  Se2 T_map_scan;
  double score = 0.0;  ///< mean likelihood of the echoes, 0 .. 1
  std::int64_t lookups = 0;
};

/// The best pose in a window, by branch and bound over translations for each angle (Olson,
/// "Real-time correlative scan matching", ICRA 2009; Hess et al., ICRA 2016). Nothing below
/// `least_score`, or where more than `most_lookups` would be needed: work is counted, not timed.
std::optional<CorrelativeMatch> match_correlative(const LikelihoodGrid& grid,
                                                  const std::vector<SurfacePoint>& scan,
                                                  const Se2& T_map_scan, const SearchWindow& window,
                                                  double least_score,
                                                  std::int64_t most_lookups = 500'000'000);

}  // namespace cairn
