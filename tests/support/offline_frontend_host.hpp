// SPDX-License-Identifier: BSD-3-Clause
// What a front-end gives to a host without a daemon.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/replay/settle.hpp"
#include "frontends/api/frontend.hpp"

namespace cairn::test {

/// A host without a daemon: what comes is in a map at once, which is settled now and then.
class OfflineFrontendHost final : public FrontendContext {
 public:
  [[nodiscard]] FrontendRoles roles() const override { return asked; }
  [[nodiscard]] const std::string& robot() const override { return robot_; }
  [[nodiscard]] std::uint64_t epoch() const override { return 1; }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return before; }
  Result<void> submit_keyframe(Transaction transaction) override {
    ++keyframes;
    return take(std::move(transaction));
  }
  Result<void> submit_loops(Transaction transaction) override {
    loops += transaction.factors.size();
    since_solve_ += transaction.factors.size();
    return take(std::move(transaction));
  }
  Result<ContentHash> send_payload(const std::string&, const std::string& bytes) override {
    return content_hash(bytes);
  }
  void localize(const LocalizedFrame& frame) override { frames.push_back(frame); }
  void tell(const std::string& text) override { told.push_back(text); }

  /// From start to stop; the first error ends it.
  Result<void> run(Frontend& frontend, const std::vector<LaserScan>& scans) {
    if (auto started = frontend.start(*this); !started) return started;
    for (const LaserScan& scan : scans) {
      if (auto done = frontend.process(scan); !done) return done;
      if (since_solve_ < 10) continue;
      if (auto settled = settle_map(frontend); !settled) return settled;
    }
    if (auto settled = settle_map(frontend); !settled) return settled;
    return frontend.stop();
  }
  /// Where the laser was at each frame.
  [[nodiscard]] std::vector<Se2> trajectory() const {
    const std::map<std::uint64_t, Se2> poses = keyframe_poses();
    std::vector<Se2> all;
    for (const LocalizedFrame& frame : frames)
      all.push_back(poses.at(frame.keyframe.index) * frame.T_keyframe_body);
    return all;
  }
  [[nodiscard]] std::map<std::uint64_t, Se2> keyframe_poses() const {
    std::map<std::uint64_t, Se2> poses;
    for (NodeIndex i = 0; i < head_.graph().nodes.size(); ++i) {
      const Estimate& e = head_.graph().estimates[i];
      poses[head_.graph().nodes[i].id.index] = Se2(e[0], e[1], e[2]);
    }
    return poses;
  }

  FrontendRoles asked;
  std::uint64_t before = 0;
  std::size_t keyframes = 0, loops = 0;
  std::vector<LocalizedFrame> frames;
  std::vector<Transaction> taken;  ///< in their order
  std::vector<std::string> told;

 private:
  Result<void> take(Transaction transaction) {
    transaction.key = {"laser", 1, ++number_};
    if (const auto refusal = head_.check(transaction))
      return Error{ErrorCode::kNotUsable, refusal->reason};
    head_.apply(transaction, {1, 0, number_});
    taken.push_back(std::move(transaction));
    return {};
  }
  Result<void> settle_map(Frontend& frontend) {
    since_solve_ = 0;
    const SettledEstimate solved = settle(head_.graph());
    if (!solved.summary.usable()) return Error{ErrorCode::kNotUsable, "the map is not settled"};
    head_.apply_estimates(changed_estimates(head_.graph(), solved), head_.graph().graph_revision,
                          {1, 0, ++number_});
    MapSnapshot snapshot;
    PoseChunk chunk;
    chunk.frame = {robot_, 1};
    for (NodeIndex i = 0; i < head_.graph().nodes.size(); ++i)
      chunk.poses.push_back({head_.graph().nodes[i].id.index, 0, head_.graph().estimates[i]});
    snapshot.changed.push_back(std::move(chunk));
    frontend.on_snapshot(snapshot);
    return {};
  }

  std::string robot_ = "robot";
  MapHead head_;
  std::uint64_t number_ = 0;
  std::size_t since_solve_ = 0;
};

}  // namespace cairn::test
