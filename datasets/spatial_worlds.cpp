// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "datasets/visits.hpp"
#include "datasets/walk.hpp"

namespace cairn {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;
using Eigen::Vector3d;

// Poses on a surface p(i) with outward normal up(i), looking to where the next one is.
template <class Position, class Up>
std::vector<Se3> poses_along(std::size_t count, const Position& position, const Up& up) {
  std::vector<Se3> poses;
  poses.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i);
    poses.push_back(pose_looking(position(t), position(t + 0.5) - position(t - 0.5), up(t)));
  }
  return poses;
}

std::size_t turn_length(std::size_t poses, double turns_per_root) {
  const double length = std::sqrt(static_cast<double>(poses) / turns_per_root);
  return std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(length)));
}

std::uint32_t narrow(std::size_t i) { return static_cast<std::uint32_t>(i); }

}  // namespace

Se3 pose_looking(const Vector3d& p_map, const Vector3d& ahead, const Vector3d& up) {
  Eigen::Matrix3d R_map_body;
  R_map_body.col(2) = up.normalized();
  R_map_body.col(1) = R_map_body.col(2).cross(ahead).normalized();
  R_map_body.col(0) = R_map_body.col(1).cross(R_map_body.col(2));
  return {So3::project(R_map_body), p_map};
}

Walk<Se3> walk_sphere(std::size_t poses) {
  const std::size_t turn = turn_length(poses, 1.0);
  const double radius_m = static_cast<double>(turn);  // as sphere2500: 50 poses per turn, 50 m
  const auto up = [&](double i) -> Vector3d {
    const double longitude = kTau * i / static_cast<double>(turn);
    const double latitude = (i / static_cast<double>(poses) - 0.5) * 0.9 * std::numbers::pi;
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
            std::sin(latitude)};
  };
  Walk<Se3> walk{poses_along(
                     poses, [&](double i) -> Vector3d { return radius_m * up(i); }, up),
                 {}};
  for (std::size_t i = turn; i < poses; ++i) walk.loops.push_back({narrow(i - turn), narrow(i)});
  return walk;
}

Walk<Se3> walk_torus(std::size_t poses) {
  const std::size_t turn = turn_length(poses, 2.0);  // twice as many turns as poses in a turn
  const double tube_m = static_cast<double>(turn) / kTau, ring_m = 3.0 * tube_m;
  const auto up = [&](double i) -> Vector3d {
    const double around_ring = kTau * i / static_cast<double>(poses);
    const double around_tube = kTau * i / static_cast<double>(turn);
    return {std::cos(around_tube) * std::cos(around_ring),
            std::cos(around_tube) * std::sin(around_ring), std::sin(around_tube)};
  };
  const auto position = [&](double i) -> Vector3d {
    const double around_ring = kTau * i / static_cast<double>(poses);
    return tube_m * up(i) + ring_m * Vector3d(std::cos(around_ring), std::sin(around_ring), 0.0);
  };
  Walk<Se3> walk{poses_along(poses, position, up), {}};
  for (std::size_t i = turn; i < poses; ++i) {
    walk.loops.push_back({narrow(i - turn), narrow(i)});
    const std::size_t first_turn = i + turn - poses;  // the coil bites its tail
    if (i + turn >= poses && first_turn + turn < i)
      walk.loops.push_back({narrow(first_turn), narrow(i)});
  }
  return walk;
}

// Stations are metres of an oval course of 100 m. On each floor the car takes two laps, seeing on
// the second what it saw on the first, then half a lap of ramp. At the top it turns and comes all
// the way down in the other lane, 3 m further out, seeing the stations of its way up.
Walk<Se3> walk_garage(std::size_t poses) {
  constexpr std::size_t kLap = 100, kFlat = 2 * kLap, kStorey = kFlat + kLap / 2;
  constexpr double kFloorM = 3.0, kLaneM = 3.0;
  const double top = 0.5 * static_cast<double>(poses - 1);
  const auto position = [&](double i) -> Vector3d {
    const double station = i <= top ? i : 2.0 * top - i;
    const double angle = kTau * station / kLap;
    const double floor = std::floor(station / kStorey);
    const double ramp = std::max(0.0, (station - floor * kStorey - kFlat) / (kStorey - kFlat));
    const double lane = kLaneM * std::clamp(0.5 + 0.1 * (i - top), 0.0, 1.0);
    return {(20.0 + lane) * std::cos(angle), (12.0 + lane) * std::sin(angle),
            kFloorM * (floor + ramp)};
  };
  Walk<Se3> walk{poses_along(poses, position, [](double) -> Vector3d { return Vector3d::UnitZ(); }),
                 {}};
  for (std::size_t i = 0; i <= poses / 2; ++i) {
    const bool second_lap = i % kStorey >= kLap && i % kStorey < kFlat;
    if (second_lap) walk.loops.push_back({narrow(i - kLap), narrow(i)});
  }
  constexpr std::size_t kGap = 12;  // poses around the turn at the top are odometry's business
  for (std::size_t i = poses / 2 + 1; i < poses; ++i) {
    const std::size_t opposite = poses - 1 - i;
    for (const std::size_t from : {opposite - 1, opposite, opposite + 1}) {
      if (from < poses && from + kGap <= i) walk.loops.push_back({narrow(from), narrow(i)});
    }
  }
  return walk;
}

namespace {

// The robot turns by a quarter about one of its axes, then goes one cell ahead.
class GridWalker {
 public:
  explicit GridWalker(std::size_t poses)
      : side_(std::max(2,
                       static_cast<int>(std::lround(std::cbrt(static_cast<double>(poses) / 2.0))))),
        visits_(static_cast<std::size_t>(side_ * side_) * static_cast<std::size_t>(side_), poses) {
    cell_.setConstant(side_ / 2);
  }

  Walk<Se3> walk(std::size_t poses, Random& random) {
    Walk<Se3> walk;
    walk.poses.reserve(poses);
    for (std::uint32_t i = 0; i < poses; ++i) {
      if (i > 0) step(random);
      walk.poses.emplace_back(So3::project(R_map_body_.cast<double>()), cell_.cast<double>());
      find_closures(i, random, walk.loops);
      visits_.add(index(cell_));
    }
    return walk;
  }

 private:
  [[nodiscard]] bool inside(const Eigen::Vector3i& cell) const {
    return cell.minCoeff() >= 0 && cell.maxCoeff() < side_;
  }
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& cell) const {
    return static_cast<std::size_t>((cell.z() * side_ + cell.y()) * side_ + cell.x());
  }

  void step(Random& random) {
    Eigen::Matrix3i turned;
    do {
      turned = R_map_body_ * kQuarterTurns()[random.index(6)];
    } while (!inside(cell_ + turned.col(0)));
    R_map_body_ = turned;
    cell_ += turned.col(0);
  }

  // Straight on (twice), left, right, up, down: columns are the new axes in the old ones.
  static const std::array<Eigen::Matrix3i, 6>& kQuarterTurns() {
    static const std::array<Eigen::Matrix3i, 6> turns = [] {
      std::array<Eigen::Matrix3i, 6> all;
      all[0].setIdentity();
      all[1].setIdentity();
      all[2] << 0, -1, 0, 1, 0, 0, 0, 0, 1;
      all[3] = all[2].transpose();
      all[4] << 0, 0, -1, 0, 1, 0, 1, 0, 0;
      all[5] = all[4].transpose();
      return all;
    }();
    return turns;
  }

  void find_closures(std::uint32_t to, Random& random, std::vector<LoopPair>& loops) {
    constexpr std::uint32_t kGap = 6;
    constexpr double kProbability = 0.3;
    const std::array<Eigen::Vector3i, 7> around{
        {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    for (const Eigen::Vector3i& offset : around) {
      const Eigen::Vector3i cell = cell_ + offset;
      if (!inside(cell)) continue;
      const std::uint32_t from = visits_.newest(index(cell));
      if (from != Visits::kNone && to - from >= kGap && random.chance(kProbability))
        loops.push_back({from, to});
    }
  }

  int side_;
  Visits visits_;
  Eigen::Vector3i cell_;
  Eigen::Matrix3i R_map_body_ = Eigen::Matrix3i::Identity();
};

}  // namespace

Walk<Se3> walk_grid(std::size_t poses, Random& random) {
  return GridWalker(poses).walk(poses, random);
}

}  // namespace cairn
