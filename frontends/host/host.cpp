// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/host.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <set>
#include <thread>

#include "cairn/core/output_file.hpp"
#include "cairn/core/stopwatch.hpp"
#include "frontends/host/tum.hpp"

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

std::uint64_t random_epoch() {
  std::random_device random;
  return std::uint64_t{random()} << 32 | random();
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

Result<void> FrontendHost::run(const MakeFrontend& make, FrameSource& source,
                               const std::function<bool()>& keep_going) {
  live_ = source.is_live();
  observer_ = source.observer();
  frame_ = {options_.robot, live_ ? random_epoch() : tracker_->epoch()};
  if (live_) keyframes_before_ = 0;
  if (auto begun = begin_epoch(make); !begun) return begun;
  const auto begin = std::chrono::steady_clock::now();
  while (!keep_going || keep_going()) {
    wait_for_turn(begin);
    const Result<NextFrame> next = source.next();
    if (!next) return next.error();
    if (std::holds_alternative<EndOfInput>(*next)) break;
    deliver_snapshot();
    if (const auto* frame = std::get_if<SensorFrame>(&*next)) {
      if (auto done = process(make, *frame); !done) return done;
    }
  }
  if (auto stopped = frontend_->stop(); !stopped) return stopped;
  if (auto decided = wait_for(0); !decided) return decided;
  return live_ ? Result<void>() : wait_for_scans();
}

// Of a log, they are not left in the spool: nobody may run the same log again. Time counts from the
// last one that was stored.
Result<void> FrontendHost::wait_for_scans() const {
  constexpr std::chrono::milliseconds kPause(20);
  std::uint64_t left = tracker_->unstored_payloads();
  auto patience = options_.timeout;
  while (left > 0) {
    if (patience <= kPause)
      return Error{ErrorCode::kUnreachable,
                   std::to_string(left) +
                       " scans are not stored by the daemon yet; they are in the "
                       "spool: run the same again to send them"};
    std::this_thread::sleep_for(kPause);
    const std::uint64_t now = tracker_->unstored_payloads();
    patience = now < left ? options_.timeout : patience - kPause;
    left = now;
  }
  return {};
}

void FrontendHost::wait_for_turn(std::chrono::steady_clock::time_point begin) const {
  if (options_.rate_hz <= 0.0) return;
  const std::chrono::duration<double> until(static_cast<double>(counts_.frames) / options_.rate_hz);
  std::this_thread::sleep_until(begin +
                                std::chrono::duration_cast<std::chrono::nanoseconds>(until));
}

// Keyframes that an interrupted run has sent are counted through all epochs.
Result<void> FrontendHost::begin_epoch(const MakeFrontend& make) {
  if (frontend_) {
    if (auto stopped = frontend_->stop(); !stopped) return stopped;
    keyframes_before_ -= std::min(keyframes_before_, keyframes_of_epoch_);
    keyframes_of_epoch_ = 0;
    ++frame_.epoch;
  }
  Result<std::unique_ptr<Frontend>> made = make();
  if (!made) return made.error();
  frontend_ = std::move(*made);
  ++counts_.epochs;
  if (observer_ != nullptr) observer_->on_epoch(frame_);
  return frontend_->start(*this);
}

Result<void> FrontendHost::process(const MakeFrontend& make, const SensorFrame& frame) {
  const std::int64_t stamp_ns = std::visit([](const auto& f) { return f.stamp_ns; }, frame);
  const auto newest = watch_.newest();
  if (watch_.begins_anew(stamp_ns)) {
    std::fprintf(stderr,
                 "warning: %s: frame %llu is %.1f s behind the newest: a new epoch begins, with a "
                 "map of its own\n",
                 options_.robot.c_str(), static_cast<unsigned long long>(counts_.frames + 1),
                 1e-9 * (static_cast<double>(*newest) - static_cast<double>(stamp_ns)));
    if (auto begun = begin_epoch(make); !begun) return begun;
  }
  const Stopwatch watch;
  latest_.reset();
  if (auto done = frontend_->process(frame); !done) return done;
  constexpr std::size_t kMostTimes = 1'000'000;
  counts_.frame_s.resize(std::min<std::size_t>(counts_.frames + 1, kMostTimes));
  counts_.frame_s[counts_.frames++ % kMostTimes] = watch.seconds();
  if (observer_ != nullptr && latest_) observer_->on_localized(frame, *latest_);
  return options_.lockstep ? keep_step() : Result<void>();
}

void FrontendHost::deliver_snapshot() {
  MapSnapshot snapshot;
  {
    const std::lock_guard lock(mutex_);
    if (arrived_.changed.empty()) return;
    snapshot = std::exchange(arrived_, {});
  }
  frontend_->on_snapshot(snapshot);
  if (observer_ != nullptr) observer_->on_snapshot(snapshot);
}

void FrontendHost::localize(const LocalizedFrame& frame) {
  keyframes_of_epoch_ = std::max(keyframes_of_epoch_, frame.keyframe.index + 1);
  latest_ = frame;
  if (options_.keep_frames) localized_.push_back(frame);
}

void FrontendHost::tell(const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", options_.robot.c_str(), text.c_str());
}

Result<void> FrontendHost::submit_keyframe(Transaction transaction) {
  ++counts_.keyframes;
  if (observer_ != nullptr) observer_->on_keyframe(transaction);
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

// The world does not wait for a daemon: what a live source brings stays in the spool until one is
// there.
Result<void> FrontendHost::keep(Result<Submission> taken) {
  if (!taken) return taken.error();
  waiting_.push_back(std::move(*taken));
  return live_ ? take_decided() : wait_for(kMostUndecided);
}

// Until no more than so many are undecided.
Result<void> FrontendHost::wait_for(std::size_t at_most) {
  while (waiting_.size() > at_most) {
    const Result<Receipt> receipt = waiting_.front().wait(options_.timeout);
    if (!receipt) return receipt.error();
    if (auto taken = take_receipt(*receipt); !taken) return taken;
  }
  return {};
}

Result<void> FrontendHost::take_decided() {
  while (!waiting_.empty()) {
    const Result<Receipt> receipt = waiting_.front().wait(std::chrono::milliseconds(0));
    if (!receipt && receipt.error().code == ErrorCode::kUnreachable) return {};
    if (!receipt) return receipt.error();
    if (auto taken = take_receipt(*receipt); !taken) return taken;
  }
  return {};
}

Result<void> FrontendHost::take_receipt(const Receipt& receipt) {
  if (receipt.refusal)
    return Error{
        ErrorCode::kNotUsable,
        "transaction " + std::to_string(receipt.key.sequence) + " of " + receipt.key.source +
            " was refused: " + std::string(to_string(*receipt.refusal)) + ": " + receipt.reason};
  newest_ = std::max(newest_, receipt.revision);
  waiting_.pop_front();
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
  std::set<std::string> maps;
  std::set<OdometryFrame> frames;
  for (const LocalizedFrame& frame : localized_) frames.insert(frame.keyframe.frame);
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, chunk] : poses_) {
      if (frames.contains(chunk.frame)) maps.insert(chunk.map);
      for (const PoseEstimate& pose : chunk.poses)
        pose_of.emplace(NodeId{chunk.frame, pose.index},
                        Se2(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]));
    }
  }
  if (maps.size() > 1)
    std::fprintf(stderr,
                 "warning: %s: its lines are of %zu maps that nothing ties together: each begins "
                 "at its own origin\n",
                 path.c_str(), maps.size());
  std::string text = kTumHeader;
  for (const LocalizedFrame& frame : localized_) {
    const auto keyframe = pose_of.find(frame.keyframe);
    if (keyframe == pose_of.end())
      return Error{ErrorCode::kNotUsable,
                   "the daemon has not told the pose of " + to_string(frame.keyframe)};
    text += tum_line(frame.stamp_ns, keyframe->second * frame.T_keyframe_body);
  }
  return write_file(path, text);
}

}  // namespace cairn
