// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/linear/kernel.hpp"
#include "cairn/solver/relative_pose_graph.hpp"

namespace cairn {

/// Chordal initialization where landmarks close the loops: rotations, positions and landmarks
/// together in one linear least-squares problem over unconstrained matrices, rotations projected,
/// then positions and landmarks again with these rotations. Uses every factor that measures a
/// relative pose, or alone tells where a point is from a pose; others are ignored. Held poses keep
/// their value. False (and `values` unchanged) when a system is singular.
template <class Pose>
bool chordal_poses_and_landmarks(const Problem& problem, const RelativePoseGraph<Pose>& graph,
                                 Kernel kernel, Values& values);

}  // namespace cairn
