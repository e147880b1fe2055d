// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "cairn/geometry/geodesy.hpp"
#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// A keyframe's pose. `T_map_body` is a guess in the robot's own frame; `stamp_ns` a label.
void add_pose(Transaction& transaction, const NodeId& node, const Se2& T_map_body,
              std::int64_t stamp_ns = 0);
void add_pose(Transaction& transaction, const NodeId& node, const Se3& T_map_body,
              std::int64_t stamp_ns = 0);

/// A measured relative pose of two nodes that exist or are added before. Information in metres and
/// radians, translation first.
void add_between(Transaction& transaction, const NodeId& a, const NodeId& b, const Se2& T_a_b,
                 const Eigen::Matrix3d& information, FactorKind kind = FactorKind::kOdometry);
void add_between(Transaction& transaction, const NodeId& a, const NodeId& b, const Se3& T_a_b,
                 const Eigen::Matrix<double, 6, 6>& information,
                 FactorKind kind = FactorKind::kOdometry);

/// A fix of GNSS: the antenna, which sits at `p_body_antenna` on the body, was at `antenna`.
/// Information in metres, along east, north and up there. `datum` says where the map lies; it must
/// be that of the daemon's map (Status::datum) where there is one.
void add_gnss(Transaction& transaction, const NodeId& node, const Eigen::Vector3d& p_body_antenna,
              const Geodetic& antenna, const Eigen::Matrix3d& information, const Geodetic& datum);

}  // namespace cairn
