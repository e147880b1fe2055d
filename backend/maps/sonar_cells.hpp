// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "cairn/maps/grid_index.hpp"
#include "cairn/maps/range_scan.hpp"

namespace cairn {

/// A sonar, or any range finder with a wide beam: how sure it is, falling linearly with the range
/// and as a Gaussian with the angle from the beam's axis.
struct SonarModel {
  double farthest_m = 5.0;      ///< what is further is not looked at
  double half_beam_rad = 0.26;  ///< of the cone
  double sigma_rad = 0.13;      ///< of the Gaussian
  double range_sigma_m = 0.05;  ///< the echo came from a shell twice as thick, or from nowhere
  std::int16_t hit = 600;       ///< log odds of the shell at range 0, on the axis, 1/1000
  std::int16_t miss = -400;     ///< of what is before it
};

/// What one scan says of the cells of one tile: log odds, 1/1000; 0: nothing.
struct SonarEvidence {
  std::array<std::int16_t, kTileArea> log_odds;
};

/// The inverse model of a sonar: what one scan says of the grid. Of several beams that meet a cell
/// the most certain says where an echo came from; only where there was none, what is free.
class SonarCells {
 public:
  using Evidence = SonarEvidence;

  explicit SonarCells(SonarModel model = {}) : model_(model) {}

  /// As LaserCells::trace; a scan that spreads over more than 2^12 cells says nothing.
  void trace(const RangeScan& scan, const Se2& T_map_body, double resolution_m);

  template <class Visit>
  void for_each_tile(const Visit& visit) const {
    SonarEvidence evidence;
    for (std::int32_t y = 0; y < tile_side_; ++y) {
      for (std::int32_t x = 0; x < tile_side_; ++x) {
        if (take(x, y, evidence)) visit(TileIndex{first_.x + x, first_.y + y}, evidence);
      }
    }
  }

  /// What a beam that measured `range_m` says of a point at a distance along it and an angle from
  /// its axis; log odds, 1/1000.
  [[nodiscard]] std::int16_t evidence_at(double range_m, double distance_m, double angle_rad) const;

 private:
  bool open_box(const Eigen::Vector2d& p_map_sonar, double reach_m, double resolution_m);
  void mark_cone(const Se2& T_map_beam, double range_m, bool echo, double resolution_m);
  void note(std::int64_t row, std::int64_t column, std::int16_t log_odds);
  [[nodiscard]] bool take(std::int32_t x, std::int32_t y, SonarEvidence& evidence) const;

  SonarModel model_;
  TileIndex first_;
  std::int32_t tile_side_ = 0;          // the box is a square of so many tiles
  std::vector<std::int16_t> log_odds_;  // by row and column of the box
};

}  // namespace cairn
