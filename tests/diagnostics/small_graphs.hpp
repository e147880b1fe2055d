// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "cairn/factors/bearing.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/prior.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn::test {

/// Planar poses one metre apart along x, without factors.
inline Graph chain(const std::vector<std::uint64_t>& ids) {
  Graph graph;
  double x = 0.0;
  for (const std::uint64_t id : ids) {
    EXPECT_TRUE(graph.add_pose2(VariableId{id}, Se2(x, 0.0, 0.0)));
    x += 1.0;
  }
  return graph;
}

inline void add_between(Graph& graph, std::uint64_t a, std::uint64_t b,
                        const Se2& T_a_b = Se2(1.0, 0.0, 0.0),
                        FactorKind kind = FactorKind::kOther) {
  ASSERT_TRUE(graph.add_factor(
      BetweenSe2{.T_a_b_measured = T_a_b, .information = Eigen::Matrix3d::Identity()},
      {VariableId{a}, VariableId{b}}, kind));
}

}  // namespace cairn::test
