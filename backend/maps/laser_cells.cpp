// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/laser_cells.hpp"

#include <cmath>

#include "cairn/maps/ray_path.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kTileBits = 6;
constexpr std::int64_t kMaxSpread = 1 << 14;  // cells
static_assert(1 << kTileBits == kTileCells, "a row of a tile is one word");

// The bits from `first` to `last`, both included.
constexpr std::uint64_t bits(std::int64_t first, std::int64_t last) {
  return (~std::uint64_t{0} << first) & (~std::uint64_t{0} >> (63 - last));
}

}  // namespace

void LaserCells::aim(const RangeScan& scan) {
  if (scan.first_angle_rad == first_angle_rad_ && scan.angle_step_rad == angle_step_rad_ &&
      scan.ranges_m.size() <= directions_.size())
    return;
  first_angle_rad_ = scan.first_angle_rad;
  angle_step_rad_ = scan.angle_step_rad;
  directions_.clear();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle = first_angle_rad_ + static_cast<double>(i) * angle_step_rad_;
    directions_.emplace_back(std::cos(angle), std::sin(angle));
  }
}

bool LaserCells::place_beams(const RangeScan& scan, const Se2& T_map_laser, double resolution_m) {
  const double scale = static_cast<double>(kSubcells) / resolution_m;
  const auto to_grid = [&](const Eigen::Vector2d& p_map) {
    return GridPoint{std::llround(p_map.x() * scale), std::llround(p_map.y() * scale)};
  };
  const double limit = (kMaxCell - kMaxSpread) * resolution_m;
  if (!(T_map_laser.translation().cwiseAbs().maxCoeff() < limit)) return false;
  start_ = to_grid(T_map_laser.translation());
  const double farthest_m =
      std::min(limits_.farthest_m, static_cast<double>(kMaxSpread) * resolution_m);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    if (!std::isfinite(range_m) || !(range_m > 0.0)) continue;
    const bool answered = range_m < scan.max_range_m;
    const bool echo = answered && range_m <= farthest_m;
    const double free_m = std::min(answered ? range_m : limits_.no_echo_free_m, farthest_m);
    if (free_m > 0.0) beams_.push_back({to_grid(T_map_laser * (free_m * directions_[i])), echo});
  }
  return true;
}

bool LaserCells::open_box() {
  GridPoint low = start_, high = start_;
  for (const Beam& beam : beams_) {
    low = {std::min(low.x, beam.end.x), std::min(low.y, beam.end.y)};
    high = {std::max(high.x, beam.end.x), std::max(high.y, beam.end.y)};
  }
  const auto tile_of = [](std::int64_t subcell) {
    return static_cast<std::int32_t>(cell_of(subcell) >> kTileBits);
  };
  if (cell_of(high.x) - cell_of(low.x) >= kMaxSpread ||
      cell_of(high.y) - cell_of(low.y) >= kMaxSpread)
    return false;
  first_ = {tile_of(low.x), tile_of(low.y)};
  tile_columns_ = tile_of(high.x) - first_.x + 1;
  tile_rows_ = tile_of(high.y) - first_.y + 1;
  const auto words = static_cast<std::size_t>(tile_columns_) * tile_rows_ * kTileCells;
  hits_.assign(words, 0);
  misses_.assign(words, 0);
  return true;
}

void LaserCells::mark_free(GridPoint end) {
  const std::int64_t first_row = std::int64_t{first_.y} << kTileBits;
  const std::int64_t first_column = std::int64_t{first_.x} << kTileBits;
  for_each_run(start_, end, [&](std::int64_t row, std::int64_t from, std::int64_t to) {
    std::uint64_t* words = misses_.data() + (row - first_row) * tile_columns_;
    from -= first_column;
    to -= first_column;
    const std::int64_t first_word = from >> kTileBits, last_word = to >> kTileBits;
    if (first_word == last_word) {
      words[first_word] |= bits(from & 63, to & 63);
      return;
    }
    words[first_word] |= bits(from & 63, 63);
    for (std::int64_t word = first_word + 1; word < last_word; ++word) words[word] = ~0ULL;
    words[last_word] |= bits(0, to & 63);
  });
}

void LaserCells::mark_hit(GridPoint end) {
  const std::int64_t row = cell_of(end.y) - (std::int64_t{first_.y} << kTileBits);
  const std::int64_t column = cell_of(end.x) - (std::int64_t{first_.x} << kTileBits);
  hits_[static_cast<std::size_t>(row * tile_columns_ + (column >> kTileBits))] |=
      bits(column & 63, column & 63);
}

void LaserCells::trace(const RangeScan& scan, const Se2& T_map_body, double resolution_m) {
  beams_.clear();
  tile_rows_ = tile_columns_ = 0;
  aim(scan);
  if (!place_beams(scan, T_map_body * scan.T_body_laser, resolution_m) || beams_.empty()) return;
  if (!open_box()) return;
  for (const Beam& beam : beams_) mark_free(beam.end);
  for (const Beam& beam : beams_) {
    if (beam.echo) mark_hit(beam.end);
  }
}

bool LaserCells::take(std::int32_t x, std::int32_t y, LaserEvidence& evidence) const {
  const std::size_t columns = static_cast<std::size_t>(tile_columns_);
  std::size_t word =
      static_cast<std::size_t>(y) * kTileCells * columns + static_cast<std::size_t>(x);
  std::uint64_t any = 0;
  for (int row = 0; row < kTileCells; ++row, word += columns) {
    evidence.hits[row] = hits_[word];
    evidence.misses[row] = misses_[word] & ~hits_[word];
    any |= hits_[word] | misses_[word];
  }
  return any != 0;
}

}  // namespace cairn
