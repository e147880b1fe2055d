// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"
#include "cairn/geometry/geodesy.hpp"
#include "cairn/graph/transaction.hpp"

/// What travels between daemon and clients besides transactions and receipts, without middleware.
namespace cairn {

/// What an estimate was computed from.
struct EstimateRevisions {
  Revision graph{};   ///< everything up to this record is in the estimate, if only by composition
  Revision solved{};  ///< the newest record that a committed solve has seen

  friend bool operator==(const EstimateRevisions&, const EstimateRevisions&) = default;
};

/// A pose in the numbers of NewVariable: x y theta (four unused zeros), or x y z qx qy qz qw.
using PoseNumbers = std::array<double, 7>;

/// Daemon to client, latest kept per source: what the daemon will not forget.
struct SourceState {
  std::string source{};
  std::uint64_t epoch = 0;
  std::uint64_t highest_decided = 0;  ///< every sequence up to this one is decided; 0: none
  Revision revision{};                ///< the head when this was said
  ContentHash chain{};                ///< the journal's chained hash at `revision`
  std::int64_t daemon_ns = 0;         ///< which run of the daemon says this: its start

  friend bool operator==(const SourceState&, const SourceState&) = default;
};

/// Client to daemon, latest kept per source: here I am, and this was promised to me.
struct ClientState {
  std::string source{};
  std::uint64_t epoch = 0;
  std::string robot{};                ///< empty: none
  std::uint64_t highest_decided = 0;  ///< highest sequence with a final receipt
  Revision receipted{};               ///< of that receipt; above the daemon's head means damage
  std::uint64_t oldest_kept = 0;      ///< first sequence the spool can still resend
  std::int64_t sent_ns = 0;           ///< the client's clock, for the clock offset
  std::int64_t daemon_ns = 0;         ///< the run of the daemon that it was said to; 0: to any

  friend bool operator==(const ClientState&, const ClientState&) = default;
};

struct PoseEstimate {
  std::uint64_t index = 0;  ///< of the node
  std::int64_t stamp_ns = 0;
  PoseNumbers T_map_body{};

  friend bool operator==(const PoseEstimate&, const PoseEstimate&) = default;
};

/// A stretch of one robot's trajectory, in node order. Replaces the chunk of the same frame and
/// number. A frame has poses of one type.
struct PoseChunk {
  OdometryFrame frame{};
  std::uint32_t chunk = 0;  ///< 0, 1, 2, ... along the trajectory
  std::string map{};        ///< frames with the same map are comparable
  VariableType type = VariableType::kPose2;
  std::vector<PoseEstimate> poses{};  ///< at most kMaxChunk

  friend bool operator==(const PoseChunk&, const PoseChunk&) = default;
};

struct LandmarkEstimate {
  std::uint64_t index = 0;
  std::array<double, 3> p_map{};  ///< z = 0 for point2

  friend bool operator==(const LandmarkEstimate&, const LandmarkEstimate&) = default;
};

/// Like PoseChunk, for the landmarks that a frame names.
struct LandmarkChunk {
  OdometryFrame frame{};
  std::uint32_t chunk = 0;
  std::string map{};
  VariableType type = VariableType::kPoint2;
  std::vector<LandmarkEstimate> landmarks{};  ///< at most kMaxChunk

  friend bool operator==(const LandmarkChunk&, const LandmarkChunk&) = default;
};

constexpr std::size_t kMaxChunk = 256;  ///< poses or landmarks in one chunk

/// Where a robot's odometry frame lies in the map, at its newest keyframe.
struct Correction {
  OdometryFrame frame{};
  std::string map{};
  VariableType type = VariableType::kPose2;
  PoseNumbers T_map_odom{};
  std::int64_t stamp_ns = 0;  ///< of that keyframe
  double jump_m = 0.0;        ///< how far this moved the robot's newest keyframe
  double jump_rad = 0.0;
  EstimateRevisions revisions{};

  friend bool operator==(const Correction&, const Correction&) = default;
};

/// A scan or an image, named by the hash of its bytes.
struct Payload {
  std::string source{};
  std::uint64_t epoch = 0;
  std::uint64_t number = 0;  ///< 1, 2, 3, ...: the n-th payload of this spool
  ContentHash hash{};
  std::string type{};   ///< "laser_scan/1", ...: what the bytes are
  std::string bytes{};  ///< at most kMaxPayloadBytes
};
constexpr std::size_t kMaxPayloadBytes = 16u << 20;

enum class PayloadAnswer : std::uint8_t { kStored = 0, kWanted = 1, kRefused = 2, kBusy = 3 };

/// The daemon's answer to a payload, or its question for one that a transaction names.
struct PayloadReceipt {
  std::string source{};
  std::uint64_t epoch = 0;
  std::uint64_t number = 0;  ///< 0 where a payload is wanted that was never seen
  ContentHash hash{};
  PayloadAnswer answer = PayloadAnswer::kStored;
  std::string reason{};
};

/// Who asked, and the how-many-eth question of that client this is. Commands are idempotent by it.
struct CommandKey {
  std::uint64_t client = 0;  ///< random
  std::uint64_t number = 0;

  friend auto operator<=>(const CommandKey&, const CommandKey&) = default;
  friend bool operator==(const CommandKey&, const CommandKey&) = default;
};

struct Command {
  CommandKey key{};
  std::string text{};  ///< a verb and its options, as on the command line
};

struct Reply {
  CommandKey key{};
  std::optional<ErrorCode> error{};  ///< nothing: done
  std::string text{};                ///< the answer, or the error's message; any size
};

enum class DaemonState : std::uint8_t {
  kStarting = 0,
  kServing = 1,
  kRefilling = 2,
  kStopping = 3
};

/// One source as the daemon sees it.
struct SourceStatus {
  std::string source{};
  std::uint64_t epoch = 0;
  bool alive = false;
  std::uint64_t highest_decided = 0;
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;
  std::uint64_t held = 0;            ///< waiting for an earlier one or for another source
  std::int64_t clock_offset_ns = 0;  ///< the client's clock minus ours at arrival
  std::string last_refusal{};        ///< code and reason
  std::vector<std::pair<RefusalCode, std::uint64_t>> refused_by_code{};
};

/// The daemon's pulse, latest kept.
struct Status {
  std::int64_t started_ns = 0;  ///< with `head.store`: which daemon this is; the newcomer stops
  std::string version{};        ///< of the program
  std::string host{};           ///< host name and process id
  DaemonState state = DaemonState::kStarting;
  Revision head{};  ///< durable
  EstimateRevisions estimate{};
  std::uint64_t variables = 0;
  std::uint64_t factors = 0;
  double chi2 = 0.0;  ///< of the newest estimate
  std::uint64_t memory_bytes = 0;
  std::uint64_t disk_free_bytes = 0;
  std::string message{};  ///< what needs attention; empty: nothing
  std::vector<SourceStatus> sources{};
  std::optional<Geodetic> datum{};  ///< the map is the east-north-up frame there
};

enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

/// Something happened, told once; who missed it asks by command.
struct Event {
  std::uint64_t number = 0;  ///< 1, 2, 3, ... since the daemon started
  std::int64_t time_ns = 0;  ///< the daemon's clock
  Severity severity = Severity::kInfo;
  std::string kind{};  ///< a stable word: "damage", "factor_committed", "under_constrained", ...
  Revision revision{};
  std::optional<FactorName> factor{};  ///< the one it is about
  std::string text{};                  ///< for people
};

}  // namespace cairn
