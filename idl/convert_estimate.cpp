// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "idl/convert.hpp"
#include "idl/wire_checks.hpp"

namespace cairn::wire {
namespace {

// How many numbers one estimate of this type has on the wire.
std::size_t numbers_of(VariableType type) {
  constexpr std::size_t kNumbers[] = {3, 7, 2, 3};
  return kNumbers[static_cast<std::size_t>(type)];
}

template <class Wire>
void head_to_wire(Wire& wire, const OdometryFrame& frame, const EstimateRevisions& revisions) {
  wire.robot = lend(frame.robot);
  wire.epoch = frame.epoch;
  wire.version = kVersion;
  wire.revisions = to_wire(revisions);
}

VariableType read_type(Checks& checks, unsigned type, bool pose) {
  const auto result = checks.word("type", type, VariableType::kPoint3);
  if (checks.ok() && is_pose(result) != pose)
    checks.fail(pose ? "type is a point; expected a pose" : "type is a pose; expected a point");
  return result;
}

// The frame, map and type; false where the arrays do not belong together.
template <class Chunk, class Wire>
bool read_head(Checks& checks, Chunk& chunk, const Wire& wire, bool pose) {
  checks.version(wire.version);
  chunk.frame = {.robot = checks.name("robot", wire.robot), .epoch = wire.epoch};
  chunk.chunk = wire.chunk;
  chunk.map = checks.optional_name("map", wire.map_name);
  chunk.type = read_type(checks, wire.type, pose);
  checks.count("indices", wire.indices._length, kMaxChunk);
  if (checks.ok() && wire.numbers._length != wire.indices._length * numbers_of(chunk.type))
    checks.fail("numbers has " + std::to_string(wire.numbers._length) + " entries; expected " +
                std::to_string(numbers_of(chunk.type)) + " for each of " +
                std::to_string(wire.indices._length) + " indices");
  return checks.ok();
}

}  // namespace

EstimateRevisions from_wire(const cairn_wire_EstimateRevisions& wire) {
  return {.graph = from_wire(wire.graph_revision), .solved = from_wire(wire.solved_revision)};
}

cairn_wire_Poses to_wire(const PoseChunk& chunk, const EstimateRevisions& revisions, Arena& arena) {
  cairn_wire_Poses wire{};
  head_to_wire(wire, chunk.frame, revisions);
  wire.chunk = chunk.chunk;
  wire.map_name = lend(chunk.map);
  wire.type = static_cast<std::uint8_t>(chunk.type);
  const std::size_t width = numbers_of(chunk.type);
  auto* index = make_sequence(wire.indices, chunk.poses.size(), arena);
  auto* stamp = make_sequence(wire.stamps_ns, chunk.poses.size(), arena);
  auto* number = make_sequence(wire.numbers, chunk.poses.size() * width, arena);
  for (const PoseEstimate& pose : chunk.poses) {
    *index++ = pose.index;
    *stamp++ = pose.stamp_ns;
    number = std::copy_n(pose.T_map_body.begin(), width, number);
  }
  return wire;
}

Result<PoseChunk> from_wire(const cairn_wire_Poses& wire) {
  Checks checks;
  PoseChunk chunk;
  if (!read_head(checks, chunk, wire, true)) return checks.result(std::move(chunk));
  if (wire.stamps_ns._length != wire.indices._length)
    checks.fail("stamps_ns and indices differ in length");
  if (!checks.ok()) return checks.result(std::move(chunk));
  const std::size_t width = numbers_of(chunk.type);
  chunk.poses.resize(wire.indices._length);
  for (std::size_t i = 0; i < chunk.poses.size(); ++i) {
    chunk.poses[i].index = wire.indices._buffer[i];
    chunk.poses[i].stamp_ns = wire.stamps_ns._buffer[i];
    std::copy_n(wire.numbers._buffer + i * width, width, chunk.poses[i].T_map_body.begin());
  }
  return chunk;
}

cairn_wire_Landmarks to_wire(const LandmarkChunk& chunk, const EstimateRevisions& revisions,
                             Arena& arena) {
  cairn_wire_Landmarks wire{};
  head_to_wire(wire, chunk.frame, revisions);
  wire.chunk = chunk.chunk;
  wire.map_name = lend(chunk.map);
  wire.type = static_cast<std::uint8_t>(chunk.type);
  const std::size_t width = numbers_of(chunk.type);
  auto* index = make_sequence(wire.indices, chunk.landmarks.size(), arena);
  auto* number = make_sequence(wire.numbers, chunk.landmarks.size() * width, arena);
  for (const LandmarkEstimate& landmark : chunk.landmarks) {
    *index++ = landmark.index;
    number = std::copy_n(landmark.p_map.begin(), width, number);
  }
  return wire;
}

Result<LandmarkChunk> from_wire(const cairn_wire_Landmarks& wire) {
  Checks checks;
  LandmarkChunk chunk;
  if (!read_head(checks, chunk, wire, false)) return checks.result(std::move(chunk));
  const std::size_t width = numbers_of(chunk.type);
  chunk.landmarks.resize(wire.indices._length);
  for (std::size_t i = 0; i < chunk.landmarks.size(); ++i) {
    chunk.landmarks[i].index = wire.indices._buffer[i];
    std::copy_n(wire.numbers._buffer + i * width, width, chunk.landmarks[i].p_map.begin());
  }
  return chunk;
}

cairn_wire_Correction to_wire(const Correction& correction, Arena&) {
  cairn_wire_Correction wire{};
  head_to_wire(wire, correction.frame, correction.revisions);
  wire.map_name = lend(correction.map);
  wire.type = static_cast<std::uint8_t>(correction.type);
  std::copy(correction.T_map_odom.begin(), correction.T_map_odom.end(), wire.numbers);
  wire.stamp_ns = correction.stamp_ns;
  wire.jump_m = correction.jump_m;
  wire.jump_rad = correction.jump_rad;
  return wire;
}

Result<Correction> from_wire(const cairn_wire_Correction& wire) {
  Checks checks;
  checks.version(wire.version);
  Correction correction{.frame = {.robot = checks.name("robot", wire.robot), .epoch = wire.epoch},
                        .map = checks.optional_name("map", wire.map_name),
                        .type = read_type(checks, wire.type, true),
                        .stamp_ns = wire.stamp_ns,
                        .jump_m = wire.jump_m,
                        .jump_rad = wire.jump_rad,
                        .revisions = from_wire(wire.revisions)};
  std::copy_n(wire.numbers, correction.T_map_odom.size(), correction.T_map_odom.begin());
  return checks.result(std::move(correction));
}

cairn_wire_Poses end_of_pose_round(const EstimateRevisions& revisions) {
  static const OdometryFrame kNobody;
  cairn_wire_Poses wire{};
  head_to_wire(wire, kNobody, revisions);
  wire.map_name = lend(kNobody.robot);
  return wire;
}

cairn_wire_Landmarks end_of_landmark_round(const EstimateRevisions& revisions) {
  static const OdometryFrame kNobody;
  cairn_wire_Landmarks wire{};
  head_to_wire(wire, kNobody, revisions);
  wire.map_name = lend(kNobody.robot);
  return wire;
}

}  // namespace cairn::wire
