// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cairn/geometry/se2.hpp"

namespace cairn {

struct PoseSigmas {
  double m = 0.0, rad = 0.0;  ///< of the position (its worst direction), of the heading
};

/// How far keyframes may be off relative to one of them: covariances composed along that path of
/// constraints which gives the least (Dijkstra projection: Bosse et al., "Simultaneous localization
/// and map building in large-scale cyclic environments using the Atlas framework", IJRR 2004). What
/// all constraints say together is less, so this bounds it, as far as each of them is honest.
class DriftBound {
 public:
  /// The next keyframe, by its motion since the one before (d in T Exp(d), m and rad). The first
  /// one's is not looked at.
  void add_keyframe(const Se2& T_before_this, const Eigen::Matrix3d& covariance);
  void add_loop(std::size_t from, std::size_t to, const Se2& T_from_to,
                const Eigen::Matrix3d& covariance);

  /// Of each keyframe, seen from one of them.
  [[nodiscard]] std::vector<PoseSigmas> seen_from(std::size_t keyframe) const;

  /// Where the path that gives the least leads.
  struct Seen {
    Se2 T_from_it;               ///< from the one that looks
    Eigen::Matrix3d covariance;  ///< of d in T Exp(d), m and rad
  };
  [[nodiscard]] std::vector<Seen> paths_from(std::size_t keyframe) const;

 private:
  struct Tie {
    std::size_t to;
    Se2 T_from_to;
    Eigen::Matrix3d covariance;
  };
  void tie(std::size_t from, std::size_t to, const Se2& T, const Eigen::Matrix3d& covariance);

  std::vector<std::vector<Tie>> ties_;  ///< by keyframe, both ways
};

}  // namespace cairn
