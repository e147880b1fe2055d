// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/client/client.hpp"
#include "frontends/api/frontend.hpp"

namespace cairn {

struct HostOptions {
  std::string robot;
  FrontendRoles roles{};
  std::uint32_t domain = 0;
  dds::Network network{};
  /// Folder of the spools; empty: the client's default.
  std::filesystem::path spool{};
  double rate_hz = 0.0;   ///< frames per second; 0: as fast as it goes
  bool lockstep = false;  ///< settle after each keyframe: the same bits each time
  std::chrono::milliseconds timeout{30'000};  ///< without a word of the daemon
};

/// Runs one front-end against a daemon: frames in, constraints out, optimized poses back. One
/// thread calls run().
class FrontendHost final : private FrontendContext {
 public:
  /// Gives the next frame; nothing: the input has ended. An error ends the run.
  using NextFrame = std::function<Result<std::optional<SensorFrame>>()>;

  static Result<std::unique_ptr<FrontendHost>> connect(const HostOptions& options);
  ~FrontendHost() override;

  /// Until the input ends or `keep_going` says no; then until the daemon has decided everything.
  Result<void> run(Frontend& frontend, const NextFrame& next,
                   const std::function<bool()>& keep_going = {});

  struct Counts {
    std::uint64_t frames = 0, keyframes = 0, loops = 0;
    std::vector<double> frame_s;  ///< what processing each took
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// Settles the daemon's map, and gives the answer.
  Result<std::string> settle();
  /// Where the body was at each frame, by the newest poses, as TUM lines.
  Result<void> write_trajectory(const std::string& path);

 private:
  explicit FrontendHost(const HostOptions& options) : options_(options) {}

  [[nodiscard]] FrontendRoles roles() const override { return options_.roles; }
  [[nodiscard]] const std::string& robot() const override { return options_.robot; }
  [[nodiscard]] std::uint64_t epoch() const override { return tracker_->epoch(); }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return keyframes_before_; }
  Result<void> submit_keyframe(Transaction transaction) override;
  Result<void> submit_loops(Transaction transaction) override;
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes) override;
  void localize(const LocalizedFrame& frame) override { localized_.push_back(frame); }

  Result<void> keep(Result<Submission> taken);
  Result<void> wait_for(std::size_t at_most);
  Result<void> keep_step();
  void deliver_snapshot(Frontend& frontend);

  HostOptions options_;
  std::optional<Client> tracker_, closer_;
  std::uint64_t keyframes_before_ = 0;
  std::deque<Submission> waiting_;
  Revision newest_;  ///< that the daemon has told of
  std::vector<LocalizedFrame> localized_;
  Counts counts_;

  std::mutex mutex_;  // guards what follows
  MapSnapshot arrived_;
  std::map<std::pair<OdometryFrame, std::uint32_t>, PoseChunk> poses_;
};

}  // namespace cairn
