// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/host.hpp"

#include <cmath>
#include <cstdio>
#include <thread>

#include "cairn/core/output_file.hpp"
#include "cairn/core/stopwatch.hpp"
#include "cairn/io/time_stamp.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMostUndecided = 256;

Result<Client> connect_as(const HostOptions& options, const std::string& source) {
  ClientOptions client;
  client.domain = options.domain;
  client.network = options.network;
  client.source = source;
  client.robot = options.robot;
  if (!options.spool.empty()) client.spool = options.spool / source;
  return Client::connect(client);
}

}  // namespace

Result<std::unique_ptr<FrontendHost>> FrontendHost::connect(const HostOptions& options) {
  std::unique_ptr<FrontendHost> host(new FrontendHost(options));
  Result<Client> tracker = connect_as(options, options.robot + "-tracker");
  if (!tracker) return tracker.error();
  host->tracker_.emplace(std::move(*tracker));
  Result<Client> closer = connect_as(options, options.robot + "-loops");
  if (!closer) return closer.error();
  host->closer_.emplace(std::move(*closer));
  host->keyframes_before_ = host->tracker_->next_sequence() - 1;
  host->tracker_->on_poses([raw = host.get()](const PoseUpdate& update) {
    const std::lock_guard lock(raw->mutex_);
    raw->arrived_.revisions = update.revisions;
    for (const PoseChunk& chunk : update.chunks) {
      raw->arrived_.changed.push_back(chunk);
      raw->poses_[{chunk.frame, chunk.chunk}] = chunk;
    }
  });
  return host;
}

// The clients' threads end before what their callbacks use.
FrontendHost::~FrontendHost() {
  closer_.reset();
  tracker_.reset();
}

Result<void> FrontendHost::run(Frontend& frontend, const NextFrame& next,
                               const std::function<bool()>& keep_going) {
  if (auto started = frontend.start(*this); !started) return started;
  const auto begin = std::chrono::steady_clock::now();
  while (!keep_going || keep_going()) {
    if (options_.rate_hz > 0.0)
      std::this_thread::sleep_until(
          begin +
          std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(
              static_cast<double>(counts_.frames) / options_.rate_hz)));
    Result<std::optional<SensorFrame>> frame = next();
    if (!frame) return frame.error();
    if (!*frame) break;
    deliver_snapshot(frontend);
    const Stopwatch watch;
    if (auto done = frontend.process(**frame); !done) return done;
    counts_.frame_s.push_back(watch.seconds());
    ++counts_.frames;
    if (!options_.lockstep) continue;
    if (auto settled = keep_step(); !settled) return settled;
  }
  if (auto stopped = frontend.stop(); !stopped) return stopped;
  return wait_for(0);
}

void FrontendHost::deliver_snapshot(Frontend& frontend) {
  MapSnapshot snapshot;
  {
    const std::lock_guard lock(mutex_);
    if (arrived_.changed.empty()) return;
    snapshot = std::exchange(arrived_, {});
  }
  frontend.on_snapshot(snapshot);
}

Result<void> FrontendHost::submit_keyframe(Transaction transaction) {
  ++counts_.keyframes;
  return keep(tracker_->submit_async(std::move(transaction)));
}

// A loop names keyframes that may still be on their way: the daemon waits for them.
Result<void> FrontendHost::submit_loops(Transaction transaction) {
  counts_.loops += transaction.factors.size();
  return keep(closer_->submit_async(std::move(transaction)));
}

Result<ContentHash> FrontendHost::send_payload(const std::string& type, const std::string& bytes) {
  return tracker_->send_payload(type, bytes);
}

Result<void> FrontendHost::keep(Result<Submission> taken) {
  if (!taken) return taken.error();
  waiting_.push_back(std::move(*taken));
  return wait_for(kMostUndecided);
}

// Until no more than so many are undecided.
Result<void> FrontendHost::wait_for(std::size_t at_most) {
  while (waiting_.size() > at_most) {
    const Result<Receipt> receipt = waiting_.front().wait(options_.timeout);
    if (!receipt) return receipt.error();
    if (receipt->refusal)
      return Error{ErrorCode::kNotUsable, "transaction " + std::to_string(receipt->key.sequence) +
                                              " of " + receipt->key.source + " was refused: " +
                                              std::string(to_string(*receipt->refusal)) + ": " +
                                              receipt->reason};
    newest_ = std::max(newest_, receipt->revision);
    waiting_.pop_front();
  }
  return {};
}

// A settled map depends on what is in it alone, and not on when solves happened to begin.
Result<void> FrontendHost::keep_step() {
  if (waiting_.empty()) return {};
  if (auto decided = wait_for(0); !decided) return decided;
  const Result<std::string> settled = settle();
  return settled ? Result<void>() : settled.error();
}

// "settled at STORE:ERA:NUMBER, ...": its poses come on a way of their own.
Result<std::string> FrontendHost::settle() {
  Result<std::string> settled = tracker_->command("settle", std::chrono::minutes(10));
  if (!settled) return settled;
  unsigned long long store = 0, number = 0;
  unsigned era = 0;
  if (std::sscanf(settled->c_str(), "settled at %llx:%u:%llu", &store, &era, &number) != 3)
    return Error{ErrorCode::kInternal, "the daemon's answer to settle is '" +
                                           settled->substr(0, 60) +
                                           "'; do host and daemon have the same version?"};
  newest_ = Revision{store, era, number};
  if (auto told = tracker_->wait_for(newest_, options_.timeout); !told) return told.error();
  return settled;
}

Result<void> FrontendHost::write_trajectory(const std::string& path) {
  if (newest_.number > 0) {
    if (auto told = tracker_->wait_for(newest_, options_.timeout); !told) return told;
  }
  std::map<NodeId, Se2> pose_of;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, chunk] : poses_)
      for (const PoseEstimate& pose : chunk.poses)
        pose_of.emplace(NodeId{chunk.frame, pose.index},
                        Se2(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]));
  }
  std::string text = "# stamp tx ty tz qx qy qz qw\n";
  for (const LocalizedFrame& frame : localized_) {
    const auto keyframe = pose_of.find(frame.keyframe);
    if (keyframe == pose_of.end())
      return Error{ErrorCode::kNotUsable,
                   "the daemon has not told the pose of " + to_string(frame.keyframe)};
    const Se2 T = keyframe->second * frame.T_keyframe_body;
    char line[160];
    std::snprintf(line, sizeof line, " %.9f %.9f 0 0 0 %.12f %.12f\n", T.x(), T.y(),
                  std::sin(0.5 * T.theta()), std::cos(0.5 * T.theta()));
    text += format_stamp(frame.stamp_ns) + line;
  }
  return write_file(path, text);
}

}  // namespace cairn
