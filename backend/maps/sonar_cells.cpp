// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/sonar_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

constexpr std::int64_t kMaxSpread = 1 << 12;  // cells

}  // namespace

std::int16_t SonarCells::evidence_at(double range_m, double distance_m, double angle_rad) const {
  if (std::abs(angle_rad) > model_.half_beam_rad) return 0;
  const double angle = angle_rad / model_.sigma_rad;
  const double by_angle = std::exp(-0.5 * angle * angle);
  const double by_range = std::max(0.0, 1.0 - distance_m / model_.farthest_m);
  const double shell = 2.0 * model_.range_sigma_m;
  const double beyond_m = distance_m - range_m;
  double log_odds = 0.0;
  if (std::abs(beyond_m) <= shell)
    log_odds = model_.hit * (1.0 - std::abs(beyond_m) / (2.0 * shell));
  else if (beyond_m < 0.0)
    log_odds = model_.miss;
  return static_cast<std::int16_t>(std::lround(log_odds * by_angle * by_range));
}

bool SonarCells::open_box(const Eigen::Vector2d& p_map_sonar, double reach_m, double resolution_m) {
  const double tile_m = kTileCells * resolution_m;
  if (!(p_map_sonar.cwiseAbs().maxCoeff() + reach_m < (kMaxCell - kMaxSpread) * resolution_m) ||
      2.0 * reach_m > kMaxSpread * resolution_m)
    return false;
  const auto tile_of = [&](double at_m) {
    return static_cast<std::int32_t>(std::floor(at_m / tile_m));
  };
  first_ = {tile_of(p_map_sonar.x() - reach_m), tile_of(p_map_sonar.y() - reach_m)};
  tile_side_ = std::max(tile_of(p_map_sonar.x() + reach_m) - first_.x,
                        tile_of(p_map_sonar.y() + reach_m) - first_.y) +
               1;
  const auto side = static_cast<std::size_t>(tile_side_) * kTileCells;
  log_odds_.assign(side * side, 0);
  return true;
}

void SonarCells::note(std::int64_t row, std::int64_t column, std::int16_t log_odds) {
  const std::int64_t side = std::int64_t{tile_side_} * kTileCells;
  std::int16_t& known = log_odds_[static_cast<std::size_t>(row * side + column)];
  if (log_odds > 0 || known > 0)
    known = std::max(known, log_odds);
  else
    known = std::min(known, log_odds);
}

void SonarCells::mark_cone(const Se2& T_map_beam, double range_m, bool echo, double resolution_m) {
  const double reach_m = std::min(range_m + 2.0 * model_.range_sigma_m, model_.farthest_m);
  const double answer_m = echo ? range_m : std::numeric_limits<double>::infinity();
  const Eigen::Vector2d low_m(first_.x * kTileCells * resolution_m,
                              first_.y * kTileCells * resolution_m);
  const Eigen::Vector2d p_box_beam = (T_map_beam.translation() - low_m) / resolution_m;
  const double reach = reach_m / resolution_m;
  const Se2 T_beam_map = T_map_beam.inverse();
  const auto from = [&](double center) { return static_cast<std::int64_t>(center - reach); };
  const auto to = [&](double center) { return static_cast<std::int64_t>(center + reach); };
  const std::int64_t side = std::int64_t{tile_side_} * kTileCells;
  for (std::int64_t row = std::max<std::int64_t>(0, from(p_box_beam.y()));
       row <= std::min(side - 1, to(p_box_beam.y())); ++row) {
    for (std::int64_t column = std::max<std::int64_t>(0, from(p_box_beam.x()));
         column <= std::min(side - 1, to(p_box_beam.x())); ++column) {
      const Eigen::Vector2d center(static_cast<double>(column) + 0.5,
                                   static_cast<double>(row) + 0.5);
      const Eigen::Vector2d p_beam = T_beam_map * (low_m + resolution_m * center);
      const double distance_m = p_beam.norm();
      if (distance_m > reach_m) continue;
      note(row, column, evidence_at(answer_m, distance_m, std::atan2(p_beam.y(), p_beam.x())));
    }
  }
}

void SonarCells::trace(const RangeScan& scan, const Se2& T_map_body, double resolution_m) {
  tile_side_ = 0;
  const Se2 T_map_sonar = T_map_body * scan.T_body_laser;
  if (!open_box(T_map_sonar.translation(), model_.farthest_m, resolution_m)) return;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    if (!std::isfinite(range_m) || !(range_m > 0.0)) continue;
    const double angle = scan.first_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
    const bool echo = range_m < scan.max_range_m && range_m <= model_.farthest_m;
    mark_cone(T_map_sonar * Se2(0.0, 0.0, angle), range_m, echo, resolution_m);
  }
}

bool SonarCells::take(std::int32_t x, std::int32_t y, SonarEvidence& evidence) const {
  const auto side = static_cast<std::size_t>(tile_side_) * kTileCells;
  bool any = false;
  for (std::size_t row = 0; row < kTileCells; ++row) {
    const auto* from = log_odds_.data() + (static_cast<std::size_t>(y) * kTileCells + row) * side +
                       static_cast<std::size_t>(x) * kTileCells;
    for (std::size_t column = 0; column < kTileCells; ++column) {
      evidence.log_odds[row * kTileCells + column] = from[column];
      any = any || from[column] != 0;
    }
  }
  return any;
}

}  // namespace cairn
