// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "datasets/visits.hpp"
#include "datasets/walk.hpp"

namespace cairn {
namespace {

constexpr double kStepM = 1.0;
constexpr std::array<std::array<int, 2>, 4> kHeadings{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

struct StreetPlan {
  int block_steps;             ///< between two crossings
  int visits_per_place;        ///< on average; sets the size of the town
  int closure_reach;           ///< cells around the robot where it recognizes a place
  int closure_depth;           ///< how many earlier visits of one cell it may recognize
  double closure_probability;  ///< for each of them
  std::uint32_t closure_gap;   ///< steps that must lie between the two poses
};

class StreetWalker {
 public:
  StreetWalker(const StreetPlan& plan, std::size_t poses)
      : plan_(plan),
        side_(blocks(plan, poses) * plan.block_steps + 1),
        visits_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), poses) {
    x_ = y_ = side_ / plan.block_steps / 2 * plan.block_steps;  // the crossing in the middle
  }

  Walk<Se2> walk(std::size_t poses, Random& random) {
    Walk<Se2> walk;
    walk.poses.reserve(poses);
    for (std::uint32_t i = 0; i < poses; ++i) {
      if (i > 0) step(random);
      walk.poses.emplace_back(kStepM * x_, kStepM * y_, heading_ * 0.5 * std::numbers::pi);
      find_closures(i, random, walk.loops);
      visits_.add(cell(x_, y_));
    }
    return walk;
  }

 private:
  // Per side, so that the streets are `poses / visits_per_place` steps long.
  static int blocks(const StreetPlan& plan, std::size_t poses) {
    const double places = static_cast<double>(poses) / plan.visits_per_place;
    return std::max(2, static_cast<int>(std::lround(std::sqrt(places / (2.0 * plan.block_steps)))));
  }

  [[nodiscard]] bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < side_ && y < side_;
  }
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }

  void step(Random& random) {
    if (x_ % plan_.block_steps == 0 && y_ % plan_.block_steps == 0) choose_street(random);
    x_ += kHeadings[heading_][0];
    y_ += kHeadings[heading_][1];
  }

  // Straight on twice as often as to either side; never out of town, never back.
  void choose_street(Random& random) {
    const std::array turns{heading_, heading_, (heading_ + 1) % 4, (heading_ + 3) % 4};
    int turn;
    do {
      turn = turns[random.index(turns.size())];
    } while (!inside(x_ + kHeadings[turn][0], y_ + kHeadings[turn][1]));
    heading_ = turn;
  }

  void find_closures(std::uint32_t to, Random& random, std::vector<LoopPair>& loops) {
    const int reach = plan_.closure_reach;
    for (int y = y_ - reach; y <= y_ + reach; ++y) {
      for (int x = x_ - reach; x <= x_ + reach; ++x) {
        if (!inside(x, y)) continue;
        std::uint32_t from = visits_.newest(cell(x, y));
        for (int depth = 0; depth < plan_.closure_depth && from != Visits::kNone; ++depth) {
          const bool far_back = to - from >= plan_.closure_gap;
          if (far_back && random.chance(plan_.closure_probability)) loops.push_back({from, to});
          from = visits_.older(from);
        }
      }
    }
  }

  StreetPlan plan_;
  int side_;
  Visits visits_;
  int x_, y_;
  int heading_ = 0;
};

}  // namespace

Walk<Se2> walk_manhattan(std::size_t poses, Random& random) {
  const StreetPlan plan{.block_steps = 4,
                        .visits_per_place = 3,
                        .closure_reach = 1,
                        .closure_depth = 1,
                        .closure_probability = 0.25,
                        .closure_gap = 8};
  return StreetWalker(plan, poses).walk(poses, random);
}

Walk<Se2> walk_city(std::size_t poses, Random& random) {
  const StreetPlan plan{.block_steps = 10,
                        .visits_per_place = 4,
                        .closure_reach = 0,
                        .closure_depth = 2,
                        .closure_probability = 0.8,
                        .closure_gap = 20};
  return StreetWalker(plan, poses).walk(poses, random);
}

}  // namespace cairn
