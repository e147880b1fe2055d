// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/truth.hpp"

#include <vector>

#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/statistics.hpp"

namespace cairn::cli {
namespace {

Se3 in_space(const Variable& pose, const Values& values) {
  if (pose.type == VariableType::kPose3) return values.pose3[pose.index];
  const Eigen::Vector2d& p = values.pose2[pose.index].translation();
  return {So3(), {p.x(), p.y(), 0.0}};  // only positions are compared
}

}  // namespace

Result<TruthComparison> compare_with_truth(const Graph& graph, const Values& values,
                                           const Graph& truth) {
  std::vector<Se3> estimated, known;
  bool planar = true;
  for (const Variable& pose : graph.variables()) {
    if (!is_pose(pose.type)) continue;
    const auto slot = truth.find(pose.id);
    if (!slot || truth.variables()[*slot].type != pose.type) continue;
    planar = planar && pose.type == VariableType::kPose2;
    estimated.push_back(in_space(pose, values));
    known.push_back(in_space(truth.variables()[*slot], truth.values()));
  }
  if (estimated.empty()) {
    return Error{ErrorCode::kBadInput,
                 "no pose of the ground truth has the id and type of a pose of the graph"};
  }
  const Alignment fit = align(AlignmentKind::kSe3, estimated, known, planar);
  std::vector<double> errors;
  for (std::size_t i = 0; i < known.size(); ++i) {
    errors.push_back((fit * known[i].translation() - estimated[i].translation()).norm());
  }
  TruthComparison comparison{.ate_rmse_m = compute_statistics(errors).rmse, .poses = errors.size()};
  comparison.T_map_truth.linear() = fit.R_reference_estimate.quaternion().toRotationMatrix();
  comparison.T_map_truth.translation() = fit.t_reference_estimate;
  return comparison;
}

}  // namespace cairn::cli
