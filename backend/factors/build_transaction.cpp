// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/build_transaction.hpp"

#include <algorithm>
#include <string_view>

#include "cairn/core/check.hpp"
#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

FactorType type_named(std::string_view name) {
  const auto types = factor_types();
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const FactorTypeInfo& info) { return info.name == name; });
  CAIRN_CHECK(found != types.end(), "no such factor type");
  return found->type;
}

std::vector<double> numbers_of(const Se2& pose) { return {pose.x(), pose.y(), pose.theta()}; }

std::vector<double> numbers_of(const Se3& pose) {
  const Eigen::Vector3d& t = pose.translation();
  Eigen::Vector4d q = pose.rotation().quaternion().coeffs();
  if (q.w() < 0.0) q = -q;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

template <class Matrix>
void add_upper_triangle(std::vector<double>& numbers, const Matrix& matrix) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = row; column < matrix.cols(); ++column)
      numbers.push_back(matrix(row, column));
}

template <class Pose, class Information>
void add_factor(Transaction& transaction, std::string_view type, const NodeId& a, const NodeId& b,
                const Pose& T_a_b, const Information& information, FactorKind kind) {
  NewFactor factor;
  factor.type = type_named(type);
  factor.kind = kind;
  factor.nodes = {a, b};
  factor.numbers = numbers_of(T_a_b);
  add_upper_triangle(factor.numbers, information);
  transaction.factors.push_back(std::move(factor));
}

}  // namespace

void add_pose(Transaction& transaction, const NodeId& node, const Se2& T_map_body,
              std::int64_t stamp_ns) {
  transaction.variables.push_back(
      {node, VariableType::kPose2, numbers_of(T_map_body), stamp_ns, {}});
}

void add_pose(Transaction& transaction, const NodeId& node, const Se3& T_map_body,
              std::int64_t stamp_ns) {
  transaction.variables.push_back(
      {node, VariableType::kPose3, numbers_of(T_map_body), stamp_ns, {}});
}

void add_between(Transaction& transaction, const NodeId& a, const NodeId& b, const Se2& T_a_b,
                 const Eigen::Matrix3d& information, FactorKind kind) {
  add_factor(transaction, "between_se2", a, b, T_a_b, information, kind);
}

void add_between(Transaction& transaction, const NodeId& a, const NodeId& b, const Se3& T_a_b,
                 const Eigen::Matrix<double, 6, 6>& information, FactorKind kind) {
  add_factor(transaction, "between_se3", a, b, T_a_b, information, kind);
}

void add_gnss(Transaction& transaction, const NodeId& node, const Eigen::Vector3d& p_body_antenna,
              const Geodetic& antenna, const Eigen::Matrix3d& information, const Geodetic& datum) {
  const LocalFrame map(datum);
  const Eigen::Vector3d p_map_antenna = map.to_local(antenna);
  const Eigen::Matrix3d R_map_enu = map.axes_of(LocalFrame(antenna));
  const Eigen::Matrix3d turned = R_map_enu * information * R_map_enu.transpose();
  NewFactor factor;
  factor.type = type_named("gnss_se3");
  factor.kind = FactorKind::kOther;
  factor.nodes = {node};
  factor.numbers.assign(p_body_antenna.begin(), p_body_antenna.end());
  factor.numbers.insert(factor.numbers.end(), p_map_antenna.begin(), p_map_antenna.end());
  add_upper_triangle(factor.numbers, turned);
  set_datum(factor, datum);
  transaction.factors.push_back(std::move(factor));
}

}  // namespace cairn
