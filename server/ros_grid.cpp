// SPDX-License-Identifier: BSD-3-Clause
#include "server/ros_grid.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;

std::int8_t to_cell(TileCell cell) {
  if (cell == TileCell::kOccupied) return kOccupied;
  return cell == TileCell::kFree ? kFree : kUnknown;
}

// The tile's cells, `shrink` by `shrink` of them as one, into rows that are `stride` long.
void draw_tile(const MapTile& tile, int shrink, std::size_t stride, std::int8_t* out) {
  for (int row = 0; row < kTileCells; ++row)
    for (int column = 0; column < kTileCells; ++column) {
      std::int8_t& cell = out[static_cast<std::size_t>(row / shrink) * stride +
                              static_cast<std::size_t>(column / shrink)];
      // In the order of the numbers: what is known wins, and an obstacle wins over free space.
      cell = std::max(cell, to_cell(tile[static_cast<std::size_t>(row * kTileCells + column)]));
    }
}

}  // namespace

void RosGrid::take(const std::map<TileIndex, MapTile>& changed, const std::vector<TileIndex>& gone,
                   double resolution_m) {
  if (std::exchange(resolution_m_, resolution_m) != resolution_m) drawn_.reset();
  for (const auto& [index, tile] : changed) {
    tiles_.insert_or_assign(index, tile);
    news_.insert(index);
  }
  for (const TileIndex& index : gone)
    if (tiles_.erase(index) > 0) news_.insert(index);
}

std::optional<RosGrid::Frame> RosGrid::find_frame() const {
  if (tiles_.empty()) return std::nullopt;
  TileIndex low = tiles_.begin()->first, high = low;
  for (const auto& [index, tile] : tiles_) {
    low = {std::min(low.x, index.x), std::min(low.y, index.y)};
    high = {std::max(high.x, index.x), std::max(high.y, index.y)};
  }
  Frame frame{low, std::int64_t{high.x} - low.x + 1, std::int64_t{high.y} - low.y + 1, 1};
  for (; frame.shrink <= kTileCells; frame.shrink *= 2) {
    const std::int64_t side = kTileCells / frame.shrink;
    // Divided, as the product of two widths may not fit.
    if (frame.columns * side <= static_cast<std::int64_t>(kMostCells) / (frame.rows * side))
      return frame;
  }
  return std::nullopt;
}

std::optional<RosGrid::Image> RosGrid::draw() {
  const auto frame = find_frame();
  if (!frame) return std::nullopt;
  const int side = kTileCells / frame->shrink;
  Image image;
  image.resolution_m = resolution_m_ * frame->shrink;
  image.origin_x_m = static_cast<double>(frame->first.x) * kTileCells * resolution_m_;
  image.origin_y_m = static_cast<double>(frame->first.y) * kTileCells * resolution_m_;
  image.width = static_cast<std::uint32_t>(frame->columns * side);
  image.height = static_cast<std::uint32_t>(frame->rows * side);
  image.cells.assign(std::size_t{image.width} * image.height, kUnknown);
  for (const auto& [index, tile] : tiles_) {
    const auto column = static_cast<std::size_t>(std::int64_t{index.x} - frame->first.x) * side;
    const auto row = static_cast<std::size_t>(std::int64_t{index.y} - frame->first.y) * side;
    draw_tile(tile, frame->shrink, image.width, &image.cells[row * image.width + column]);
  }
  news_.clear();
  drawn_ = frame;
  return image;
}

std::optional<std::vector<RosGrid::Patch>> RosGrid::draw_changed() {
  if (!drawn_ || news_.size() > kMostPatches || find_frame() != drawn_) return std::nullopt;
  const int side = kTileCells / drawn_->shrink;
  std::vector<Patch> patches;
  for (const TileIndex& index : std::exchange(news_, {})) {
    Patch patch;
    patch.x = static_cast<std::int32_t>((std::int64_t{index.x} - drawn_->first.x) * side);
    patch.y = static_cast<std::int32_t>((std::int64_t{index.y} - drawn_->first.y) * side);
    patch.side = static_cast<std::uint32_t>(side);
    patch.cells.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), kUnknown);
    if (const auto tile = tiles_.find(index); tile != tiles_.end())
      draw_tile(tile->second, drawn_->shrink, patch.side, patch.cells.data());
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace cairn
