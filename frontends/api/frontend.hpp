// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"
#include "frontends/api/laser_scan.hpp"
#include "idl/messages.hpp"

/// The seam between the host, which knows logs, topics and daemons, and front-ends, which know
/// sensors.
namespace cairn {

/// What a sensor has seen. Frames come in the order of their arrival.
using SensorFrame = std::variant<LaserScan>;

/// What a front-end is to do.
struct FrontendRoles {
  bool loop_closer = true;  ///< find loops
  bool tracker = true;      ///< keyframes and odometry, of frames; else others' keyframes come
};

/// A keyframe of any robot, as the daemon has it.
struct RobotKeyframe {
  NodeId node{};
  std::int64_t stamp_ns = 0;
  std::vector<std::string> payloads{};  ///< what was seen there; each whatever its robot sent
  bool is_new = true;  ///< false: loops that end here were looked for before, by another run
};

/// What changed of the optimized poses since the snapshot before.
struct MapSnapshot {
  EstimateRevisions revisions{};
  std::vector<PoseChunk> changed{};
};

/// Where the body was when a frame was taken, relative to a keyframe whose pose the map improves.
struct LocalizedFrame {
  std::int64_t stamp_ns = 0;
  NodeId keyframe{};
  Se2 T_keyframe_body{};
};

/// What a front-end is told and where it sends what it finds. Valid until stop() has returned.
class FrontendContext {
 public:
  virtual ~FrontendContext() = default;

  [[nodiscard]] virtual FrontendRoles roles() const = 0;
  [[nodiscard]] virtual const std::string& robot() const = 0;
  /// Of the odometry frame: the same where a run goes on that was interrupted.
  [[nodiscard]] virtual std::uint64_t epoch() const = 0;
  /// Keyframes that a run before this one has submitted: these are made again, and not sent.
  [[nodiscard]] virtual std::uint64_t keyframes_before() const = 0;

  /// One keyframe: its node and the constraints to those before. Waits while too much is undecided.
  virtual Result<void> submit_keyframe(Transaction transaction) = 0;
  /// Loop closures.
  virtual Result<void> submit_loops(Transaction transaction) = 0;
  /// Returns when it is on disk; its hash is what a factor names it by.
  virtual Result<ContentHash> send_payload(const std::string& type, const std::string& bytes) = 0;
  /// Every frame, once.
  virtual void localize(const LocalizedFrame& frame) = 0;
  /// A line for who runs the front-end, such as what a sensor cannot tell.
  virtual void tell(const std::string& text) = 0;
};

/// Makes constraints of what a sensor sees. All calls come from one thread, in the order start,
/// any of process (a tracker), on_keyframe (who is none) and on_snapshot, stop.
class Frontend {
 public:
  virtual ~Frontend() = default;

  virtual Result<void> start(FrontendContext& context) = 0;
  virtual Result<void> process(const SensorFrame& frame) = 0;
  virtual void on_snapshot(const MapSnapshot& snapshot) = 0;
  /// Once for each keyframe of every robot; a snapshot has told its pose before.
  virtual Result<void> on_keyframe(const RobotKeyframe& /*keyframe*/) { return {}; }
  /// Sends what is left.
  virtual Result<void> stop() = 0;
};

/// What a shared object exports as `cairn_frontend_plugin`.
struct FrontendPlugin {
  static constexpr std::uint32_t kVersion = 3;
  std::uint32_t version = kVersion;
  const char* name = "";
  Frontend* (*make)() = nullptr;  ///< deleted by the host
};

}  // namespace cairn
