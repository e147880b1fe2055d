// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "cairn/maps/map_tile.hpp"

namespace cairn {

/// A map as ROS's OccupancyGrid has it: row by row from the lower left corner, -1 where no scan
/// says anything or scans contradict each other, 0 free, 100 occupied. It has whole tiles; one of
/// more than kMostCells has larger cells, each of 2 x 2 (4 x 4, ...) of the map's: occupied where
/// one of them is, free where one is and none is occupied. One thread.
class RosGrid {
 public:
  static constexpr std::size_t kMostCells = 32u << 20;
  static constexpr std::size_t kMostPatches = 64;

  struct Image {
    double resolution_m = 0.0, origin_x_m = 0.0, origin_y_m = 0.0;
    std::uint32_t width = 0, height = 0;
    std::vector<std::int8_t> cells{};
  };
  /// A part of an image, from column `x` and row `y` on.
  struct Patch {
    std::int32_t x = 0, y = 0;
    std::uint32_t side = 0;
    std::vector<std::int8_t> cells{};
  };

  void take(const std::map<TileIndex, MapTile>& changed, const std::vector<TileIndex>& gone,
            double resolution_m);

  [[nodiscard]] bool is_empty() const { return tiles_.empty(); }
  /// Something is not in what draw() or draw_changed() gave last.
  [[nodiscard]] bool has_news() const { return !news_.empty(); }
  /// All of it; nothing where it is empty, or too large even with a cell for each tile.
  std::optional<Image> draw();
  /// The tiles that changed, in the image that draw() gave last; nothing where it is another one
  /// now (the map has grown) or where more than kMostPatches changed, and draw() is needed.
  std::optional<std::vector<Patch>> draw_changed();

 private:
  struct Frame {
    TileIndex first{};
    std::int64_t columns = 0, rows = 0;  ///< of tiles
    int shrink = 1;                      ///< cells of the map along a side of one of the image

    friend bool operator==(const Frame&, const Frame&) = default;
  };
  [[nodiscard]] std::optional<Frame> find_frame() const;

  std::map<TileIndex, MapTile> tiles_;
  std::set<TileIndex> news_;
  double resolution_m_ = 0.0;
  std::optional<Frame> drawn_;
};

}  // namespace cairn
