// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "cairn/history/solve_record.hpp"
#include "server/replay_journal.hpp"

namespace cairn::test {

/// The robot that others, which call themselves otherwise, see now and then on their way.
inline constexpr const char* kLeader = "robot";

/// The i-th step of a robot's drive with loops, the same at each call.
inline Transaction drive_step(const std::string& robot, std::uint64_t i) {
  std::mt19937 random(static_cast<std::uint32_t>(5 + i));
  std::normal_distribution<double> noise(0.0, 0.05);
  Transaction step;
  const NodeId pose{{robot, 3}, i};
  step.variables.push_back(
      {pose, VariableType::kPose2, {static_cast<double>(i), noise(random), 0.0}, 0, {}});
  const auto tie = [&](const NodeId& to, FactorKind kind) {
    NewFactor factor;
    factor.type = FactorType{1};
    factor.kind = kind;
    factor.nodes = {to, pose};
    factor.numbers = {static_cast<double>(i - to.index) + noise(random),
                      noise(random),
                      noise(random),
                      100.0,
                      0.0,
                      0.0,
                      100.0,
                      0.0,
                      400.0};
    step.factors.push_back(factor);
  };
  if (i > 0) tie({pose.frame, i - 1}, FactorKind::kOdometry);
  if (i >= 7) tie({pose.frame, i - 7}, FactorKind::kLoop);
  if (robot != kLeader && i % 10 == 0) tie({{kLeader, 3}, i}, FactorKind::kLoop);
  return step;
}

/// Two places of the leader that are not the same, said to be.
inline Transaction false_loop(std::uint64_t a, std::uint64_t b) {
  Transaction transaction = drive_step(kLeader, b);
  transaction.variables.clear();
  transaction.factors.resize(1);
  transaction.factors[0].kind = FactorKind::kLoop;
  transaction.factors[0].nodes = {{{kLeader, 3}, a}, {{kLeader, 3}, b}};
  return transaction;
}

/// The same drive, now and then with a second loop closure, which is false: the robot were back
/// where it was halfway. Seldom, once there are many.
inline Transaction troubled_step(const std::string& robot, std::uint64_t i) {
  Transaction step = drive_step(robot, i);
  const std::uint64_t pause = i < 200 ? 20 : 100;
  if (i % pause != pause / 2 + 1) return step;
  NewFactor wrong = step.factors.front();
  wrong.kind = FactorKind::kLoop;
  wrong.nodes.front().index = i / 2;
  step.factors.push_back(wrong);
  return step;
}

inline std::vector<Transaction> drive(std::uint64_t count) {
  std::vector<Transaction> steps;
  for (std::uint64_t i = 0; i < count; ++i) steps.push_back(drive_step(kLeader, i));
  return steps;
}

inline std::vector<Transaction> troubled_drive(std::uint64_t count) {
  std::vector<Transaction> steps;
  for (std::uint64_t i = 0; i < count; ++i) steps.push_back(troubled_step(kLeader, i));
  return steps;
}

/// What a journal says all nodes' estimates are, in order of arrival.
inline std::vector<double> estimates(const Journal& journal) {
  MapHead head;
  Sequencer sequencer;
  EXPECT_TRUE(replay_journal(journal, head, sequencer));
  std::vector<double> all;
  for (NodeIndex i = 0; i < head.graph().nodes.size(); ++i)
    all.insert(all.end(), head.graph().estimates[i].begin(), head.graph().estimates[i].end());
  return all;
}

/// What they are when nothing disturbs the run.
inline std::vector<double> settled_estimates(const std::vector<Transaction>& steps) {
  MapHead head;
  for (std::uint64_t number = 0; const Transaction& step : steps)
    head.apply(step, {1, 0, ++number});
  apply_solution(head, head.graph().graph_revision, solve_map(head.graph()),
                 {1, 0, steps.size() + 1});
  std::vector<double> all;
  for (NodeIndex i = 0; i < head.graph().nodes.size(); ++i)
    all.insert(all.end(), head.graph().estimates[i].begin(), head.graph().estimates[i].end());
  return all;
}

}  // namespace cairn::test
