// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/association.hpp"

#include <algorithm>
#include <limits>

#include "cairn/evaluation/nearest_pose.hpp"

namespace cairn {
namespace {

constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();

std::string_view described(TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::kTum:
      return "TUM (matched by time stamp)";
    case TrajectoryFormat::kKitti:
      return "KITTI (matched by line)";
    default:
      return "a graph (matched by id)";
  }
}

}  // namespace

Result<Association> associate(const Trajectory& reference, const Trajectory& estimate,
                              std::uint64_t max_difference_ns) {
  if (reference.format != estimate.format) {
    return Error{ErrorCode::kBadInput,
                 "is " + std::string(described(estimate.format)) + ", but " + reference.name +
                     " is " + std::string(described(reference.format)) +
                     "; give both in one format",
                 estimate.name};
  }
  const std::uint64_t tolerance =
      reference.format == TrajectoryFormat::kTum ? max_difference_ns : 0;
  const auto references = sorted_by_key(reference), estimates = sorted_by_key(estimate);
  std::vector<std::size_t> partner(references.size(),
                                   kNobody);  // of a reference pose: the estimate it goes to
  const auto distance = [&](std::size_t r, std::size_t e) {
    return key_difference(references[r].key, estimates[e].key);
  };
  for (std::size_t e = 0; e < estimates.size() && !references.empty(); ++e) {
    const std::size_t r = nearest_pose(references, estimates[e].key);
    if (distance(r, e) > tolerance) continue;
    if (partner[r] == kNobody || distance(r, e) < distance(r, partner[r])) partner[r] = e;
  }

  Association matches;
  for (std::size_t r = 0; r < references.size(); ++r) {
    if (partner[r] == kNobody) continue;
    matches.reference.push_back(references[r].T_world_body);
    matches.estimate.push_back(estimates[partner[r]].T_world_body);
  }
  matches.unmatched = estimates.size() - matches.estimate.size();
  if (matches.reference.empty()) {
    return Error{
        ErrorCode::kBadInput,
        "no pose has a partner in " + reference.name +
            (tolerance ? " within " + std::to_string(1e-9 * static_cast<double>(tolerance)) +
                             " s; do both use the same clock?"
                       : "; do both use the same ids?"),
        estimate.name};
  }
  return matches;
}

}  // namespace cairn
