// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cairn/core/check.hpp"

namespace cairn {
namespace {

std::vector<PosePair> pairs_by_count(std::size_t poses, std::size_t delta, bool consecutive) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i + delta < poses; i += consecutive ? delta : 1)
    pairs.emplace_back(i, i + delta);
  return pairs;
}

std::vector<PosePair> consecutive_pairs_by_path(std::span<const double> path_m, double delta_m) {
  std::vector<PosePair> pairs;
  std::size_t mark = 0;  // 0: none yet
  double mark_m = 0.0;
  for (std::size_t i = 1; i < path_m.size(); ++i) {
    if (path_m[i] - mark_m < delta_m) continue;
    if (mark > 0) pairs.emplace_back(mark, i);
    mark = i;
    mark_m = path_m[i];
  }
  return pairs;
}

std::vector<PosePair> all_pairs_by_path(std::span<const double> path_m, double delta_m) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0, j = 0; i < path_m.size(); ++i) {
    while (j < path_m.size() && path_m[j] - path_m[i] < delta_m) ++j;
    if (j == path_m.size()) break;
    pairs.emplace_back(i, j);
  }
  return pairs;
}

}  // namespace

void PoseErrors::add(const Se3& E, std::size_t where) {
  translation_m.push_back(E.translation().norm());
  rotation_deg.push_back(E.rotation().log().norm() * 180.0 / std::numbers::pi);
  at.push_back(where);
}

PoseErrors absolute_errors(std::span<const Se3> reference, std::span<const Se3> estimate) {
  CAIRN_CHECK(reference.size() == estimate.size(), "errors of unmatched trajectories");
  PoseErrors errors;
  for (std::size_t i = 0; i < reference.size(); ++i)
    errors.add(reference[i].inverse() * estimate[i], i);
  return errors;
}

PoseErrors relative_errors(std::span<const Se3> reference, std::span<const Se3> estimate,
                           std::span<const PosePair> pairs) {
  CAIRN_CHECK(reference.size() == estimate.size(), "errors of unmatched trajectories");
  PoseErrors errors;
  for (const auto& [i, j] : pairs) {
    const Se3 T_ri_rj = reference[i].inverse() * reference[j];
    const Se3 T_ei_ej = estimate[i].inverse() * estimate[j];
    errors.add(T_ri_rj.inverse() * T_ei_ej, j);
  }
  return errors;
}

std::vector<PosePair> choose_pairs(std::span<const Se3> estimate, const PairSpacing& spacing) {
  CAIRN_CHECK(spacing.delta > 0.0 && (spacing.in_metres || spacing.delta >= 1.0),
              "pairs without distance");
  if (!spacing.in_metres) {
    return pairs_by_count(estimate.size(), static_cast<std::size_t>(std::min(spacing.delta, 1e15)),
                          spacing.consecutive);
  }
  const std::vector<double> path_m = path_lengths(estimate);
  return spacing.consecutive ? consecutive_pairs_by_path(path_m, spacing.delta)
                             : all_pairs_by_path(path_m, spacing.delta);
}

std::vector<double> path_lengths(std::span<const Se3> poses) {
  std::vector<double> path_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path_m[i] = path_m[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return path_m;
}

}  // namespace cairn
