// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "cairn/maps/grid_index.hpp"
#include "cairn/maps/range_scan.hpp"

namespace cairn {

/// How much of a laser's scan is believed.
struct LaserLimits {
  double farthest_m = 30.0;  ///< what is further is not looked at; a beam is free up to there
  /// A beam without echo is free up to here: far away there may be glass, or nothing.
  double no_echo_free_m = 0.0;
};

/// What one scan says of the cells of one tile. Row by row, a bit per cell (the lowest: the first
/// column): an echo came from it, or beams passed through it and no echo came from it.
struct LaserEvidence {
  std::array<std::uint64_t, kTileCells> hits, misses;
};

/// The inverse model of a laser: which cells of the grid one scan hits, and which it sees to be
/// free, each once, however many beams meet it. Kept from scan to scan for its memory.
class LaserCells {
 public:
  using Evidence = LaserEvidence;

  explicit LaserCells(LaserLimits limits = {}) : limits_(limits) {}

  /// Looks at a scan. One that lies beyond the grid (kMaxCell), or spreads over more than 2^14
  /// cells, says nothing.
  void trace(const RangeScan& scan, const Se2& T_map_body, double resolution_m);

  /// Calls visit(TileIndex, const LaserEvidence&) for each tile of which the last scan says
  /// something, row by row.
  template <class Visit>
  void for_each_tile(const Visit& visit) const {
    LaserEvidence evidence;
    for (std::int32_t y = 0; y < tile_rows_; ++y) {
      for (std::int32_t x = 0; x < tile_columns_; ++x) {
        if (take(x, y, evidence)) visit(TileIndex{first_.x + x, first_.y + y}, evidence);
      }
    }
  }

 private:
  struct Beam {
    GridPoint end;
    bool echo;
  };

  void aim(const RangeScan& scan);
  bool place_beams(const RangeScan& scan, const Se2& T_map_laser, double resolution_m);
  bool open_box();
  void mark_free(GridPoint end);
  void mark_hit(GridPoint end);
  [[nodiscard]] bool take(std::int32_t x, std::int32_t y, LaserEvidence& evidence) const;

  LaserLimits limits_;
  std::vector<Eigen::Vector2d> directions_;  // of the beams, for the angles below
  double first_angle_rad_ = 0.0, angle_step_rad_ = 0.0;

  GridPoint start_;
  std::vector<Beam> beams_;
  // The tiles around them as one bit image: rows of tile_columns_ words each.
  TileIndex first_;
  std::int32_t tile_rows_ = 0, tile_columns_ = 0;
  std::vector<std::uint64_t> hits_, misses_;
};

}  // namespace cairn
