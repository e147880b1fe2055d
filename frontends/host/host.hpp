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
#include "frontends/host/epoch_watch.hpp"
#include "frontends/host/frame_source.hpp"

namespace cairn {

struct HostOptions {
  std::string robot;
  FrontendRoles roles{};
  std::uint32_t domain = 0;
  dds::Network network{};
  /// Folder of the spools; empty: the client's default.
  std::filesystem::path spool{};
  double rate_hz = 0.0;      ///< frames per second; 0: as fast as it goes
  bool lockstep = false;     ///< settle after each keyframe: the same bits each time
  bool keep_frames = false;  ///< for write_trajectory()
  std::chrono::milliseconds timeout{30'000};  ///< without a word of the daemon
};

/// Runs a front-end against a daemon: frames in, constraints out, optimized poses back. Where
/// stamps go back by more than 2 s (EpochWatch) a new front-end begins, in an odometry frame of its
/// own. Of a live source each run is one: the robot may have been carried meanwhile, and the daemon
/// is not waited for. One thread calls run().
class FrontendHost final : private FrontendContext {
 public:
  /// Makes the front-end of an epoch.
  using MakeFrontend = std::function<Result<std::unique_ptr<Frontend>>()>;

  static Result<std::unique_ptr<FrontendHost>> connect(const HostOptions& options);
  ~FrontendHost() override;

  /// Until the input ends or `keep_going` says no; then until the daemon has decided everything.
  Result<void> run(const MakeFrontend& make, FrameSource& source,
                   const std::function<bool()>& keep_going = {});

  struct Counts {
    std::uint64_t frames = 0, keyframes = 0, loops = 0, epochs = 0;
    std::vector<double> frame_s;  ///< what processing each took, of the last million
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
  [[nodiscard]] std::uint64_t epoch() const override { return frame_.epoch; }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return keyframes_before_; }
  Result<void> submit_keyframe(Transaction transaction) override;
  Result<void> submit_loops(Transaction transaction) override;
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes) override;
  void localize(const LocalizedFrame& frame) override;
  void tell(const std::string& text) override;

  Result<void> keep(Result<Submission> taken);
  Result<void> wait_for(std::size_t at_most);
  [[nodiscard]] Result<void> wait_for_scans() const;
  Result<void> take_decided();
  Result<void> take_receipt(const Receipt& receipt);
  Result<void> begin_epoch(const MakeFrontend& make);
  Result<void> process(const MakeFrontend& make, const SensorFrame& frame);
  void wait_for_turn(std::chrono::steady_clock::time_point begin) const;
  Result<void> keep_step();
  void deliver_snapshot();

  HostOptions options_;
  std::optional<Client> tracker_, closer_;
  std::uint64_t keyframes_before_ = 0;  ///< of this epoch
  std::uint64_t keyframes_of_epoch_ = 0;
  OdometryFrame frame_;
  EpochWatch watch_;
  std::unique_ptr<Frontend> frontend_;
  HostObserver* observer_ = nullptr;
  bool live_ = false;
  std::optional<LocalizedFrame> latest_;
  std::deque<Submission> waiting_;
  Revision newest_;  ///< that the daemon has told of
  std::vector<LocalizedFrame> localized_;
  Counts counts_;

  std::mutex mutex_;  // guards what follows
  MapSnapshot arrived_;
  std::map<std::pair<OdometryFrame, std::uint32_t>, PoseChunk> poses_;
};

}  // namespace cairn
