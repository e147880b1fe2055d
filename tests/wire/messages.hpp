// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "cairn/graph/transaction.hpp"
#include "idl/messages.hpp"

namespace cairn::test {

/// The transaction with one keyframe and its odometry factor that a robot sends at every step.
inline Transaction step(const std::string& source, std::uint64_t epoch, std::uint64_t sequence) {
  const OdometryFrame frame{.robot = source, .epoch = 1};
  Transaction step{.key = {.source = source, .epoch = epoch, .sequence = sequence},
                   .sent_ns = 1'700'000'000'000'000'000,
                   .variables = {},
                   .factors = {},
                   .edits = {}};
  step.variables.push_back({.node = {frame, sequence},
                            .type = VariableType::kPose2,
                            .start = {1.0 * static_cast<double>(sequence), 0.5, -0.25},
                            .stamp_ns = -7,
                            .odometry = {1.0, 2.0, 3.0}});
  step.factors.push_back({.type = FactorType{2},
                          .kind = FactorKind::kLoop,
                          .nodes = {{frame, sequence - 1}, {frame, sequence}},
                          .numbers = {1.0, 0.0, 0.1, 100, 0, 0, 100, 0, 400},
                          .payloads = {content_hash("scan a"), content_hash("scan b")}});
  return step;
}

inline EstimateRevisions revisions(std::uint64_t graph, std::uint64_t solved) {
  return {.graph = {.store = 9, .era = 0, .number = graph},
          .solved = {.store = 9, .era = 0, .number = solved}};
}

inline PoseChunk chunk(const std::string& robot, std::uint32_t number, std::size_t count) {
  PoseChunk chunk{.frame = {.robot = robot, .epoch = 1},
                  .chunk = number,
                  .map = "m",
                  .type = VariableType::kPose3,
                  .poses = {}};
  for (std::size_t i = 0; i < count; ++i)
    chunk.poses.push_back({.index = number * kMaxChunk + i,
                           .stamp_ns = static_cast<std::int64_t>(i),
                           .T_map_body = {1, 2, static_cast<double>(i), 0, 0, 0, 1}});
  return chunk;
}

}  // namespace cairn::test
