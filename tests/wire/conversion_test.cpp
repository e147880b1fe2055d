// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "idl/convert.hpp"
#include "idl/limits.hpp"
#include "tests/wire/messages.hpp"

namespace cairn {
namespace {

using testing::HasSubstr;

template <class Message, class... More>
Message round_trip(const Message& message, const More&... more) {
  wire::Arena arena;
  auto result = wire::from_wire(wire::to_wire(message, more..., arena));
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? *result : Message{};
}

void expect_same(const NewFactor& a, const NewFactor& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.numbers, b.numbers);
  EXPECT_EQ(a.payloads, b.payloads);
}

void expect_same(const NewVariable& a, const NewVariable& b) {
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  EXPECT_EQ(a.odometry, b.odometry);
}

TEST(Conversion, CarriesEveryFieldOfATransaction) {
  Transaction sent = test::step("wheels", 5, 300);
  sent.edits.push_back(
      {.factor = {.transaction = {.source = "other", .epoch = 8, .sequence = 2}, .index = 3},
       .change = FactorChange::kRemove});
  const Transaction received = round_trip(sent, std::uint64_t{77});
  EXPECT_EQ(received.key, sent.key);
  EXPECT_EQ(received.sent_ns, sent.sent_ns);
  ASSERT_EQ(received.variables.size(), 1u);
  expect_same(received.variables[0], sent.variables[0]);
  ASSERT_EQ(received.factors.size(), 1u);
  expect_same(received.factors[0], sent.factors[0]);
  ASSERT_EQ(received.edits.size(), 1u);
  EXPECT_EQ(received.edits[0].factor, sent.edits[0].factor);
  EXPECT_EQ(received.edits[0].change, sent.edits[0].change);
}

TEST(Conversion, CarriesReceiptsWithAndWithoutRefusal) {
  Receipt receipt{.key = {.source = "s", .epoch = 1, .sequence = 257},
                  .revision = {.store = 3, .era = 2, .number = 1}};
  EXPECT_FALSE(round_trip(receipt).refusal);
  receipt.refusal = RefusalCode::kBusy;
  receipt.reason = "two of them";
  const Receipt received = round_trip(receipt);
  EXPECT_EQ(received.key, receipt.key);
  EXPECT_EQ(received.revision, receipt.revision);
  EXPECT_EQ(received.refusal, RefusalCode::kBusy);
  EXPECT_EQ(received.reason, "two of them");
}

TEST(Conversion, CarriesStatesOfSourcesAndClients) {
  const SourceState source{.source = "s",
                           .epoch = 4,
                           .highest_decided = 5,
                           .revision = {1, 2, 3},
                           .chain = content_hash("chain"),
                           .daemon_ns = 6};
  EXPECT_EQ(round_trip(source), source);
  const ClientState client{.source = "s",
                           .epoch = 4,
                           .robot = "",
                           .highest_decided = 9,
                           .receipted = {7, 8, 9},
                           .oldest_kept = 2,
                           .sent_ns = -1,
                           .daemon_ns = 8};
  EXPECT_EQ(round_trip(client, std::uint64_t{1}), client);
}

TEST(Conversion, CarriesEstimatesInTheirDimension) {
  const EstimateRevisions revisions = test::revisions(8, 7);
  const PoseChunk poses3 = test::chunk("r", 2, kMaxChunk);
  EXPECT_EQ(round_trip(poses3, revisions), poses3);
  PoseChunk poses2 = poses3;
  poses2.type = VariableType::kPose2;
  for (PoseEstimate& pose : poses2.poses) pose.T_map_body = {1, 2, 3, 0, 0, 0, 0};
  EXPECT_EQ(round_trip(poses2, revisions), poses2);
  const LandmarkChunk landmarks{.frame = {"r", 1},
                                .chunk = 0,
                                .map = "",
                                .type = VariableType::kPoint3,
                                .landmarks = {{.index = 4, .p_map = {1, 2, 3}}}};
  EXPECT_EQ(round_trip(landmarks, revisions), landmarks);
  const Correction correction{.frame = {"r", 1},
                              .map = "m",
                              .type = VariableType::kPose2,
                              .T_map_odom = {1, 2, 3},
                              .stamp_ns = 4,
                              .jump_m = 0.5,
                              .jump_rad = 0.25,
                              .revisions = revisions};
  EXPECT_EQ(round_trip(correction), correction);
}

TEST(Conversion, CarriesPayloadsStatusAndEvents) {
  const Payload payload{.source = "s",
                        .epoch = 1,
                        .number = 17,
                        .hash = content_hash("bytes"),
                        .type = "laser_scan/1",
                        .bytes = std::string("by\0tes", 6)};
  EXPECT_EQ(round_trip(payload, std::uint64_t{1}).bytes, payload.bytes);
  const PayloadReceipt answer{.source = "s",
                              .epoch = 1,
                              .number = 17,
                              .hash = payload.hash,
                              .answer = PayloadAnswer::kWanted};
  EXPECT_EQ(round_trip(answer).answer, PayloadAnswer::kWanted);
  Status status;
  status.version = "0.2";
  status.chi2 = 1.5;
  status.sources.push_back({.source = "s", .epoch = 1, .held = 4, .last_refusal = "malformed"});
  EXPECT_EQ(round_trip(status).sources.at(0).last_refusal, "malformed");
  EXPECT_EQ(round_trip(status).chi2, 1.5);
  EXPECT_FALSE(round_trip(status).datum);
  status.datum = Geodetic{47.0, 8.5, 400.0};
  EXPECT_EQ(round_trip(status).datum, status.datum);
  Event event;
  event.kind = "factor_committed";
  EXPECT_FALSE(round_trip(event).factor);
  event.factor = FactorName{.transaction = {"s", 1, 2}, .index = 3};
  EXPECT_EQ(round_trip(event).factor, event.factor);
}

TEST(Conversion, CutsLongReasonsBetweenCharacters) {
  Receipt receipt{.key = {.source = "s", .epoch = 1, .sequence = 1}, .revision = {}};
  receipt.refusal = RefusalCode::kMalformed;
  receipt.reason = "x";
  while (receipt.reason.size() < limits::kReason) receipt.reason += "\xC3\xA9";
  EXPECT_EQ(round_trip(receipt).reason.size(), limits::kReason - 1);
}

// What a stranger may send, and what is said about it.
struct Hostile {
  const char* name;
  std::function<void(cairn_wire_Transaction&)> spoil;
  const char* reason;
};

TEST(Conversion, RefusesWhatBreaksTheRulesOfTheWire) {
  static std::string long_name(70, 'x');
  static char empty[] = "";
  const Hostile kTable[] = {
      {"newer", [](auto& w) { w.version = 2; }, "has format version 2, this Cairn knows version 1"},
      {"no version", [](auto& w) { w.version = 0; }, "has format version 0"},
      {"no source", [](auto& w) { w.source = nullptr; }, "source has 0 bytes; expected 1 to 64"},
      {"empty source", [](auto& w) { w.source = empty; }, "source has 0 bytes; expected 1 to 64"},
      {"long source", [](auto& w) { w.source = long_name.data(); }, "source has 65 bytes"},
      {"sequence 0", [](auto& w) { w.sequence_number = 0; }, "sequence is 0; expected 1 or more"},
      {"slot", [](auto& w) { w.slot = 9; }, "slot is 9; expected sequence mod 256 = 44"},
      {"a million variables", [](auto& w) { w.variables._length = 1'000'000; },
       "variables has 1000000 entries; expected at most 10000"},
      {"a million factors", [](auto& w) { w.factors._length = 1'000'000; },
       "factors has 1000000 entries; expected at most 20000"},
      {"a million edits", [](auto& w) { w.edits._length = 1'000'000; },
       "edits has 1000000 entries; expected at most 10000"},
      {"variable type", [](auto& w) { w.variables._buffer[0].type = 4; },
       "variables[0]: type is 4; expected 0 to 3"},
      {"long start", [](auto& w) { w.variables._buffer[0].start._length = 8; },
       "variables[0]: start has 8 entries; expected at most 7"},
      {"long odometry", [](auto& w) { w.variables._buffer[0].odometry._length = 1u << 30; },
       "variables[0]: odometry has 1073741824 entries; expected at most 7"},
      {"robot", [](auto& w) { w.variables._buffer[0].node.robot = empty; },
       "variables[0]: robot has 0 bytes; expected 1 to 64"},
      {"factor kind", [](auto& w) { w.factors._buffer[0].factor_kind = 3; },
       "factors[0]: kind is 3; expected 0 to 2"},
      {"numbers", [](auto& w) { w.factors._buffer[0].numbers._length = 1'000'000; },
       "factors[0]: numbers has 1000000 entries; expected at most 256"},
      {"nodes", [](auto& w) { w.factors._buffer[0].nodes._length = 17; },
       "factors[0]: nodes has 17 entries; expected at most 16"},
      {"payloads", [](auto& w) { w.factors._buffer[0].payloads._length = 99; },
       "factors[0]: payloads has 99 entries; expected at most 16"},
      {"robot of a factor", [](auto& w) { w.factors._buffer[0].nodes._buffer[1].robot = nullptr; },
       "factors[0]: robot has 0 bytes; expected 1 to 64"},
  };
  for (const Hostile& hostile : kTable) {
    SCOPED_TRACE(hostile.name);
    const Transaction honest = test::step("wheels", 5, 300);
    wire::Arena arena;
    cairn_wire_Transaction wire = wire::to_wire(honest, 77, arena);
    hostile.spoil(wire);
    const auto result = wire::from_wire(wire);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(result.error().message, HasSubstr(hostile.reason));
  }
}

TEST(Conversion, RefusesEstimatesWhoseArraysDoNotBelongTogether) {
  wire::Arena arena;
  const PoseChunk chunk = test::chunk("r", 0, 3);
  auto poses = wire::to_wire(chunk, test::revisions(1, 1), arena);
  poses.numbers._length = 20;
  EXPECT_FALSE(wire::from_wire(poses));
  poses = wire::to_wire(chunk, test::revisions(1, 1), arena);
  poses.stamps_ns._length = 2;
  EXPECT_FALSE(wire::from_wire(poses));
  poses = wire::to_wire(chunk, test::revisions(1, 1), arena);
  poses.type = static_cast<std::uint8_t>(VariableType::kPoint2);
  EXPECT_FALSE(wire::from_wire(poses));
}

TEST(Limits, AcceptExactlyWhatTheOtherSideCanRead) {
  EXPECT_TRUE(limits::check(test::step("wheels", 1, 1)));
  Transaction bad = test::step("wheels", 1, 1);
  bad.variables[0].start.resize(8);
  EXPECT_FALSE(limits::check(bad));
  bad = test::step("wheels", 1, 1);
  bad.factors[0].nodes[0].frame.robot = std::string("a\0b", 3);
  ASSERT_FALSE(limits::check(bad));
  EXPECT_EQ(limits::check(bad).error().message,
            "factors[0]: robot contains a zero byte; expected text");
}

}  // namespace
}  // namespace cairn
