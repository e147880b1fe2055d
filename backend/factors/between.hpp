// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/pose_error.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// Relative pose between a and b, measured as T_a_b. e = vec(T_measured^-1 * T_map_a^-1 * T_map_b),
/// vec = (x m, y m, theta rad).
struct BetweenSe2 {
  static constexpr std::string_view kName = "between_se2";
  using Variables = Signature<VariableType::kPose2, VariableType::kPose2>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = false;

  Se2 T_a_b_measured;
  Eigen::Matrix3d information;  ///< m, rad

  Eigen::Vector3d error(const Se2& T_map_a, const Se2& T_map_b, ErrorChart chart,
                        Eigen::Matrix3d* J_e_a, Eigen::Matrix3d* J_e_b) const;
  [[nodiscard]] RelativePose<Se2> relative_pose(std::uint32_t a, std::uint32_t b) const;

  /// Fast paths in the g2o chart, see TypedBatch.
  static void squared_errors(const TypedBatch<BetweenSe2>& batch, std::size_t begin,
                             std::size_t end, const Values& values, double* out);
  static RangeCost linearize(const TypedBatch<BetweenSe2>& batch, std::size_t begin,
                             std::size_t end, const EvaluationContext& context,
                             const NormalEquationTargets& targets);
};

/// Relative pose between a and b, measured as T_a_b. e = chart(T_measured^-1 * T_map_a^-1 *
/// T_map_b): translation m, then rotation as the error chart says (rad).
struct BetweenSe3 {
  static constexpr std::string_view kName = "between_se3";
  using Variables = Signature<VariableType::kPose3, VariableType::kPose3>;
  static constexpr int kDimension = 6;
  static constexpr bool kAbsolute = false;

  Se3 T_a_b_measured;
  Matrix6d information;  ///< m, rad

  Vector6d error(const Se3& T_map_a, const Se3& T_map_b, ErrorChart chart, Matrix6d* J_e_a,
                 Matrix6d* J_e_b) const;
  [[nodiscard]] Matrix6d information_in(ErrorChart chart) const {
    return pose_information(information, chart);
  }
  [[nodiscard]] RelativePose<Se3> relative_pose(std::uint32_t a, std::uint32_t b) const;

  /// Fast paths in the g2o chart, see TypedBatch.
  static void squared_errors(const TypedBatch<BetweenSe3>& batch, std::size_t begin,
                             std::size_t end, const Values& values, double* out);
  static RangeCost linearize(const TypedBatch<BetweenSe3>& batch, std::size_t begin,
                             std::size_t end, const EvaluationContext& context,
                             const NormalEquationTargets& targets);
};

extern template class TypedBatch<BetweenSe2>;
extern template class TypedBatch<BetweenSe3>;

}  // namespace cairn
