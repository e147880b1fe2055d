// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/simulated/floor_plan.hpp"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

class Draft {
 public:
  void wall(double x1, double y1, double x2, double y2, bool glass = false) {
    plan.walls.push_back({{x1, y1}, {x2, y2}, glass});
  }
  /// Along x at y, with openings [from, to] in order.
  void wall_with_doors(double y, double x1, double x2,
                       const std::vector<std::pair<double, double>>& doors) {
    for (const auto& [from, to] : doors) {
      wall(x1, y, from, y);
      x1 = to;
    }
    wall(x1, y, x2, y);
  }
  void box(double x1, double y1, double x2, double y2) {
    wall(x1, y1, x2, y1);
    wall(x2, y1, x2, y2);
    wall(x2, y2, x1, y2);
    wall(x1, y2, x1, y1);
  }

  FloorPlan plan;
};

// y 0 .. 4.5: five rooms, and the door of each to the corridor.
void southern_rooms(Draft& draft) {
  draft.wall(0, 0, 34, 0);
  for (const double x : {7.0, 14.0, 21.0, 28.0}) draft.wall(x, 0, x, 4.5);
  draft.wall_with_doors(4.5, 0, 34, {{3, 4}, {10, 11}, {17, 18}, {24, 25}, {30.5, 31.5}});
  draft.box(0.4, 0.4, 2.0, 1.2);  // desks
  draft.box(5.2, 2.6, 6.4, 3.4);
  draft.box(8.0, 0.5, 9.6, 1.3);
  draft.box(15.5, 1.0, 16.7, 2.6);
  draft.box(21.5, 0.4, 22.4, 2.8);
  draft.box(26.2, 0.6, 27.4, 1.4);
  draft.box(31.6, 0.5, 33.2, 1.6);
}

// x 2.2 .. 31.8, y 6.9 .. 19.8: rooms at the southern corridor, a hall in the west, shafts.
void core(Draft& draft) {
  draft.wall_with_doors(6.9, 2.2, 31.8, {{5, 6}, {9.6, 13.4}, {14.5, 15.5}, {20, 21}, {28, 29}});
  draft.wall(9.6, 6.9, 13.4, 6.9, true);  // of a meeting room
  for (const double x : {9.0, 17.0, 25.0}) draft.wall(x, 6.9, x, 12.5);
  draft.wall(2.2, 12.5, 31.8, 12.5);
  draft.wall(2.2, 6.9, 2.2, 15.0);
  draft.wall(2.2, 16.2, 2.2, 19.8);
  draft.wall(31.8, 6.9, 31.8, 13.0);
  draft.wall(31.8, 13.0, 30.6, 13.0);  // a niche
  draft.wall(30.6, 13.0, 30.6, 15.4);
  draft.wall(30.6, 15.4, 31.8, 15.4);
  draft.wall(31.8, 15.4, 31.8, 19.8);
  draft.wall(2.2, 19.8, 31.8, 19.8);
  draft.wall(14.0, 12.5, 14.0, 19.8);
  draft.box(7.0, 17.3, 7.5, 17.8);  // pillars
  draft.box(12.0, 17.6, 12.5, 18.1);
  draft.box(9.6, 8.4, 10.8, 11.4);  // a table
  draft.box(16.0, 11.2, 16.8, 12.2);
  draft.box(3.0, 11.4, 5.4, 12.2);
  draft.box(22.0, 9.0, 23.6, 10.2);
}

}  // namespace

Eigen::Vector2d position_of(const Walker& walker, double time_s) {
  double length = 0.0;
  for (std::size_t i = 1; i < walker.corners.size(); ++i)
    length += (walker.corners[i] - walker.corners[i - 1]).norm();
  if (length <= 0.0) return walker.corners.front();
  double way = std::fmod(walker.start_m + walker.speed_m_s * time_s, 2.0 * length);
  if (way > length) way = 2.0 * length - way;
  for (std::size_t i = 1; i < walker.corners.size(); ++i) {
    const Eigen::Vector2d leg = walker.corners[i] - walker.corners[i - 1];
    const double leg_m = leg.norm();
    if (way <= leg_m && leg_m > 0.0) return walker.corners[i - 1] + way / leg_m * leg;
    way -= leg_m;
  }
  return walker.corners.back();
}

FloorPlan office_floor() {
  Draft draft;
  draft.wall(0, 0, 0, 22);
  draft.wall(0, 22, 34, 22);
  draft.wall(34, 22, 34, 0);
  southern_rooms(draft);
  core(draft);
  FloorPlan& plan = draft.plan;
  plan.walkers = {
      {.corners = {{2.0, 6.35}, {30.0, 6.35}}, .speed_m_s = 1.1, .start_m = 20.0},
      {.corners = {{9.0, 5.05}, {29.0, 5.05}}, .speed_m_s = 0.7, .start_m = 3.0},
      {.corners = {{4.0, 13.4}, {13.0, 13.4}, {13.0, 19.0}, {4.0, 19.0}}, .speed_m_s = 0.9}};
  plan.tour = {{3.5, 2.2},  {3.5, 5.7},  {15.0, 5.7}, {15.0, 9.5}, {12.5, 10.5}, {15.0, 9.5},
               {15.0, 5.7}, {24.5, 5.7}, {24.5, 2.2}, {24.5, 5.7}, {32.9, 5.7},  {32.9, 20.9},
               {1.1, 20.9}, {1.1, 15.6}, {6.0, 15.4}, {9.5, 17.3}, {11.0, 14.8}, {6.0, 15.4},
               {1.1, 15.6}, {1.1, 5.7},  {11.0, 5.7}};
  return std::move(draft.plan);
}

}  // namespace cairn
