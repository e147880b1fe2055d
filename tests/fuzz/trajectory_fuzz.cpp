// SPDX-License-Identifier: BSD-3-Clause
// Reads TUM and KITTI trajectories; what is read is finite and holds rotations.
#include <cmath>
#include <cstdlib>

#include "cairn/io/trajectory.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto trajectory =
      cairn::read_trajectory_text({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!trajectory) return 0;
  for (const cairn::TrajectoryPose& pose : trajectory->poses) {
    const bool unit = std::abs(pose.T_world_body.rotation().quaternion().norm() - 1.0) < 1e-6;
    if (!unit || !pose.T_world_body.translation().allFinite()) std::abort();
  }
  return 0;
}
