// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/maps/range_scan.hpp"
#include "cairn/replay/map_head.hpp"
#include "frontends/api/frontend.hpp"
#include "idl/limits.hpp"

namespace cairn::test {

/// Keeps what a front-end sends, and holds each call to the contract of frontends/api/frontend.hpp
/// and to what daemon and client accept.
class RecordingContext final : public FrontendContext {
 public:
  explicit RecordingContext(FrontendRoles roles = {}) : roles_(roles) {}
  /// What a run before this one has sent: its first `count` keyframes, and the payloads that they
  /// name.
  RecordingContext(const RecordingContext& before, std::size_t count)
      : before_(count), count_(count) {
    for (std::size_t k = 0; k < count; ++k) {
      apply(before.keyframes[k]);
      for (const NewFactor& factor : before.keyframes[k].factors)
        sent_.insert(factor.payloads.begin(), factor.payloads.end());
    }
  }

  [[nodiscard]] FrontendRoles roles() const override { return roles_; }
  [[nodiscard]] const std::string& robot() const override { return frame.robot; }
  [[nodiscard]] std::uint64_t epoch() const override { return frame.epoch; }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return before_; }

  Result<void> submit_keyframe(Transaction transaction) override {
    if (refuses) return Error{ErrorCode::kNotUsable, "the disk of the spool is full"};
    EXPECT_EQ(transaction.variables.size(), 1u);
    if (transaction.variables.size() == 1) {
      EXPECT_EQ(transaction.variables[0].node, (NodeId{frame, count_}));
    }
    EXPECT_TRUE(transaction.edits.empty());
    if (count_ > 0) expect_odometry(transaction);
    for (const NewFactor& factor : transaction.factors)
      for (const ContentHash& payload : factor.payloads)
        EXPECT_TRUE(sent_.contains(payload)) << "keyframe " << count_ << " names what was not sent";
    ++count_;
    take(std::move(transaction), keyframes);
    return {};
  }
  Result<void> submit_loops(Transaction transaction) override {
    if (refuses) return Error{ErrorCode::kNotUsable, "the disk of the spool is full"};
    EXPECT_TRUE(roles_.loop_closer) << "nobody asked for loops";
    EXPECT_TRUE(transaction.variables.empty() && transaction.edits.empty());
    EXPECT_FALSE(transaction.factors.empty());
    for (const NewFactor& factor : transaction.factors) EXPECT_EQ(factor.kind, FactorKind::kLoop);
    take(std::move(transaction), loops);
    return {};
  }
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes) override {
    if (refuses) return Error{ErrorCode::kNotUsable, "the disk of the spool is full"};
    EXPECT_TRUE(!type.empty() && type.size() <= limits::kWord);
    EXPECT_LE(bytes.size(), kMaxPayloadBytes);
    if (type == kRangeScanPayload) {
      EXPECT_TRUE(decode_range_scan(bytes));
    }
    return *sent_.insert(content_hash(bytes)).first;
  }
  void tell(const std::string& text) override { EXPECT_FALSE(text.empty()); }
  void localize(const LocalizedFrame& localized) override {
    EXPECT_EQ(localized.keyframe.frame, frame);
    EXPECT_TRUE(localized.T_keyframe_body.to_vector().allFinite());
    frames.push_back(localized);
  }

  /// One call of process(), which localizes the frame once, against a keyframe that is there then.
  Result<void> process(Frontend& frontend, const SensorFrame& sensor_frame) {
    const std::size_t before = frames.size();
    auto done = frontend.process(sensor_frame);
    if (!done) return done;
    EXPECT_EQ(frames.size(), before + 1) << "a frame is localized once";
    EXPECT_EQ(frames.back().stamp_ns, std::get<LaserScan>(sensor_frame).stamp_ns);
    EXPECT_LT(frames.back().keyframe.index, count_) << "localized against a keyframe to come";
    return done;
  }
  /// The poses that a daemon would tell now.
  [[nodiscard]] MapSnapshot snapshot() const {
    MapSnapshot told;
    told.changed.push_back({.frame = frame, .chunk = 0, .map = "m", .poses = {}});
    const PoseGraph& graph = head_.graph();
    for (NodeIndex i = 0; i < graph.nodes.size(); ++i)
      told.changed[0].poses.push_back({graph.nodes[i].id.index, 0, graph.estimates[i]});
    return told;
  }

  OdometryFrame frame{"robot", 7};
  bool refuses = false;                       ///< as where the spool's disk is full
  std::vector<Transaction> keyframes, loops;  ///< in their order
  std::vector<LocalizedFrame> frames;

 private:
  void expect_odometry(const Transaction& keyframe) const {
    const auto leads_here = [&](const NewFactor& factor) {
      return factor.kind == FactorKind::kOdometry &&
             factor.nodes == std::vector<NodeId>{{frame, count_ - 1}, {frame, count_}};
    };
    EXPECT_EQ(std::count_if(keyframe.factors.begin(), keyframe.factors.end(), leads_here), 1)
        << "odometry from keyframe " << count_ - 1 << " to the next";
  }
  void take(Transaction transaction, std::vector<Transaction>& all) {
    transaction.key = {"contract", 1, ++number_};
    const auto within = limits::check(transaction);
    EXPECT_TRUE(within) << within.error().to_string();
    EXPECT_TRUE(limits::check_size(encode(transaction)));
    const auto refusal = head_.check(transaction);
    ASSERT_FALSE(refusal) << "the daemon refuses it: " << refusal->reason;
    apply(transaction);
    transaction.key = {};
    all.push_back(std::move(transaction));
  }
  void apply(const Transaction& transaction) { head_.apply(transaction, {1, 0, ++revision_}); }

  FrontendRoles roles_;
  std::uint64_t before_ = 0, count_ = 0, number_ = 0, revision_ = 0;
  std::set<ContentHash> sent_;
  MapHead head_;
};

}  // namespace cairn::test
