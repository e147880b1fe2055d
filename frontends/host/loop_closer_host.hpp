// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clients/client/client.hpp"
#include "frontends/host/host.hpp"

namespace cairn {

/// Runs a front-end that looks for loops among the keyframes of all robots: asks the daemon for
/// them, tells their poses before, and submits what is found as the source ROBOT-loops. After a
/// restart it goes on where its loops end; a daemon that was away, or lost the end of its store, is
/// asked again. One thread calls run().
class LoopCloserHost final : private FrontendContext {
 public:
  using MakeFrontend = FrontendHost::MakeFrontend;

  static Result<std::unique_ptr<LoopCloserHost>> connect(const HostOptions& options);
  ~LoopCloserHost() override;

  /// Until `keep_going` says no or, where that is set, no keyframe has come for `until_idle`; then
  /// until the daemon has decided everything.
  Result<void> run(const MakeFrontend& make, const std::function<bool()>& keep_going,
                   std::optional<std::chrono::milliseconds> until_idle = {});

  struct Counts {
    std::uint64_t keyframes = 0, loops = 0;
    std::set<std::string> robots;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// Settles the daemon's map, and gives the answer.
  Result<std::string> settle() { return client_->command("settle", std::chrono::minutes(10)); }

 private:
  explicit LoopCloserHost(const HostOptions& options) : options_(options) {}

  [[nodiscard]] FrontendRoles roles() const override { return {true, false}; }
  [[nodiscard]] const std::string& robot() const override { return options_.robot; }
  [[nodiscard]] std::uint64_t epoch() const override { return 0; }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return 0; }
  Result<void> submit_keyframe(Transaction transaction) override;
  Result<void> submit_loops(Transaction transaction) override;
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes) override;
  void localize(const LocalizedFrame& /*frame*/) override {}
  void tell(const std::string& text) override;

  struct Place {
    std::uint64_t store = 0, era = 0, next = 0;  ///< next: in the daemon's order
  };

  Result<void> begin(const MakeFrontend& make);
  Result<bool> ask(const MakeFrontend& make);
  Result<void> take(const std::string& answer, const MakeFrontend& make);
  Result<bool> hand_over();
  void deliver_snapshot();
  Result<void> wait_for(std::size_t at_most);

  HostOptions options_;
  std::string source_;
  std::optional<Client> client_;
  std::unique_ptr<Frontend> frontend_;
  Place place_;
  std::optional<std::uint64_t> closed_;  ///< keyframes before this place another run has seen to
  bool everything_ = false;              ///< the last answer went to the daemon's end
  std::set<std::uint64_t> waiting_;      ///< places whose scans have not come
  std::deque<RobotKeyframe> queue_;      ///< until their poses have come
  std::map<OdometryFrame, std::set<std::uint64_t>> posed_;  ///< indices
  std::deque<Submission> undecided_;
  Counts counts_;

  std::mutex mutex_;  // guards what follows
  MapSnapshot arrived_;
  std::map<std::pair<OdometryFrame, std::uint32_t>, PoseChunk> chunks_;
  EstimateRevisions revisions_{};
};

}  // namespace cairn
