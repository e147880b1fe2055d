// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "cairn/evaluation/trajectory_error.hpp"
#include "cairn/io/trajectory.hpp"
#include "tests/support/offline_frontend_host.hpp"

namespace cairn::test {

inline Se3 in_space(const Se2& T) {
  const double half = 0.5 * T.theta();
  return {So3(Eigen::Quaterniond(std::cos(half), 0.0, 0.0, std::sin(half))), {T.x(), T.y(), 0.0}};
}

/// Of positions, after the best rigid alignment.
inline double aligned_rmse_m(const std::vector<Se2>& truth, const std::vector<Se2>& found) {
  std::vector<Se3> expected, estimate;
  for (std::size_t i = 0; i < found.size(); ++i) {
    expected.push_back(in_space(truth[i]));
    estimate.push_back(in_space(found[i]));
  }
  const Alignment T_truth_found = align(AlignmentKind::kSe3, expected, estimate, true);
  for (Se3& T : estimate) T = T_truth_found * T;
  return compute_statistics(absolute_errors(expected, estimate).translation_m).rmse;
}

inline Trajectory as_trajectory(const OfflineFrontendHost& host) {
  const std::vector<Se2> found = host.trajectory();
  Trajectory trajectory;
  for (std::size_t i = 0; i < found.size(); ++i)
    trajectory.poses.push_back(
        {static_cast<std::uint64_t>(host.frames[i].stamp_ns), in_space(found[i])});
  return trajectory;
}

}  // namespace cairn::test
