// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/linear/elimination.hpp"
#include "cairn/linear/kernel.hpp"
#include "cairn/solver/relative_pose_graph.hpp"

namespace cairn {

/// Chordal initialization (Martinec & Pajdla 2007; Carlone et al. 2015, section IV): rotations by
/// linear least squares over unconstrained matrices, each projected to the nearest rotation, then
/// translations by linear least squares. No start is needed; held poses keep their value, and a
/// component without one is tied at its smallest id. False (and `poses` unchanged) when a system is
/// singular.
/// `known` is an elimination of the unknown poses in index order, used where it fits (that of the
/// normal equations does when there are no landmarks); otherwise one is found.
template <class Pose>
bool chordal_poses(const RelativePoseGraph<Pose>& graph, const Elimination& known, Kernel kernel,
                   std::vector<Pose>& poses);

}  // namespace cairn
