// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/map_renderer.hpp"

#include <numbers>

namespace cairn {
namespace {

constexpr double kCloseCells = 0.1;
constexpr double kCloseRad = 0.05 * std::numbers::pi / 180.0;

bool is_same(const Se2& a, const Se2& b) { return a.to_vector() == b.to_vector(); }

}  // namespace

template <class Cell, class Traced>
bool MapRenderer<Cell, Traced>::is_close(const Se2& a, const Se2& b, Precision precision) const {
  if (precision == Precision::kExact) return is_same(a, b);
  return (a.translation() - b.translation()).norm() <= kCloseCells * resolution_m_ &&
         std::abs(wrap_angle(a.theta() - b.theta())) <= kCloseRad;
}

template <class Cell, class Traced>
typename MapRenderer<Cell, Traced>::Plan MapRenderer<Cell, Traced>::plan(
    std::span<const PlacedScan> scans, Precision precision, RenderReport& report) {
  Plan plan;
  std::set<ScanId> gone;
  for (const auto& [scan, pose] : rendered_) gone.insert(scan);
  for (const PlacedScan& placed : scans) {
    gone.erase(placed.scan);
    const auto known = rendered_.find(placed.scan);
    if (known != rendered_.end() && is_close(known->second, placed.T_map_body, precision)) {
      ++report.kept;
      continue;
    }
    if (known != rendered_.end()) plan.leave.push_back(placed.scan);
    plan.come.push_back(placed);
  }
  plan.leave.insert(plan.leave.end(), gone.begin(), gone.end());
  // Where most of it goes elsewhere, beginning again is less work than taking away.
  if (plan.leave.size() > report.kept) plan = begin_again(scans, report);
  return plan;
}

template <class Cell, class Traced>
typename MapRenderer<Cell, Traced>::Plan MapRenderer<Cell, Traced>::begin_again(
    std::span<const PlacedScan> scans, RenderReport& report) {
  for (const auto& [index, tile] : grid_) report.changed.insert(index);
  grid_.clear();
  rendered_.clear();
  report.kept = 0;
  return {{}, {scans.begin(), scans.end()}};
}

template <class Cell, class Traced>
bool MapRenderer<Cell, Traced>::change(ScanId scan, const Se2& T_map_body, Sign sign,
                                       const ScanSource& source, RenderReport& report) {
  const std::shared_ptr<const RangeScan> content = source(scan);
  if (!content) return false;
  traced_.trace(*content, T_map_body, resolution_m_);
  apply(traced_, sign, grid_, [&](const TileIndex& tile) { report.changed.insert(tile); });
  return true;
}

template <class Cell, class Traced>
RenderReport MapRenderer<Cell, Traced>::render(std::span<const PlacedScan> scans,
                                               const ScanSource& source, Precision precision,
                                               const std::function<bool()>& keep_going) {
  RenderReport report;
  Plan work = plan(scans, precision, report);
  const auto stopped = [&] { return !(report.finished = !keep_going || keep_going()); };
  for (std::size_t i = 0; i < work.leave.size(); ++i) {
    if (stopped()) return report;
    const auto known = rendered_.find(work.leave[i]);
    if (!change(known->first, known->second, Sign::kTakeAway, source, report)) {
      // It was there before; what it has added can no longer be told from the rest.
      work = begin_again(scans, report);
      break;
    }
    rendered_.erase(known);
  }
  for (const PlacedScan& placed : work.come) {
    if (stopped()) return report;
    // Made anew from x, y and theta: the cosine of a product of poses is a bit off.
    const Se2 T_map_body(placed.T_map_body.x(), placed.T_map_body.y(), placed.T_map_body.theta());
    if (change(placed.scan, T_map_body, Sign::kAdd, source, report))
      rendered_.insert_or_assign(placed.scan, T_map_body);
    else
      ++report.missing;
  }
  report.added = work.come.size() - report.missing;
  return report;
}

template class MapRenderer<HitMissCell, LaserCells>;
template class MapRenderer<LogOddsCell, SonarCells>;

}  // namespace cairn
