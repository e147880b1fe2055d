// SPDX-License-Identifier: BSD-3-Clause
// What comes in: estimates, replies, and the user's callbacks.
#include <algorithm>
#include <cstdio>
#include <tuple>

#include "clients/client/engine.hpp"

namespace cairn {
namespace {

bool reaches(const Revision& have, const Revision& wanted) {
  return have.store == wanted.store &&
         std::tie(have.era, have.number) >= std::tie(wanted.era, wanted.number);
}

template <class Known, class Chunk>
void merge(Known& known, const std::vector<Chunk>& chunks) {
  for (const Chunk& chunk : chunks) known[{chunk.frame, chunk.chunk}] = chunk;
}

template <class Chunk, class Known>
std::vector<Chunk> all_of(const Known& known) {
  std::vector<Chunk> chunks;
  chunks.reserve(known.size());
  for (const auto& [key, chunk] : known) chunks.push_back(chunk);
  return chunks;
}

// Marks the thread that runs a user's callback, for as long as it does.
class InCallback {
 public:
  explicit InCallback(std::atomic<std::thread::id>& thread) : thread_(thread) {
    thread_ = std::this_thread::get_id();
  }
  ~InCallback() { thread_ = std::thread::id(); }

 private:
  std::atomic<std::thread::id>& thread_;
};

}  // namespace

void Client::Engine::on_poses(EstimateRevisions revisions, std::vector<PoseChunk> chunks) {
  {
    const std::lock_guard lock(callbacks_);
    merge(poses_, chunks);
    pose_revisions_ = revisions;
    const InCallback mark(callback_thread_);
    if (pose_callback_) pose_callback_({revisions, std::move(chunks)});
  }
  {
    const std::lock_guard lock(mutex_);
    estimate_ = revisions;
  }
  arrived_.notify_all();
}

void Client::Engine::on_landmarks(EstimateRevisions revisions, std::vector<LandmarkChunk> chunks) {
  const std::lock_guard lock(callbacks_);
  merge(landmarks_, chunks);
  landmark_revisions_ = revisions;
  const InCallback mark(callback_thread_);
  if (landmark_callback_) landmark_callback_(revisions, chunks);
}

void Client::Engine::on_correction(Correction correction) {
  const std::lock_guard lock(callbacks_);
  corrections_[correction.frame] = correction;
  const InCallback mark(callback_thread_);
  if (correction_callback_) correction_callback_(correction);
}

void Client::Engine::on_status(Status status) {
  const std::lock_guard lock(callbacks_);
  status_ = std::move(status);
  const InCallback mark(callback_thread_);
  if (status_callback_) status_callback_(*status_);
}

void Client::Engine::on_event(Event event) {
  const std::lock_guard lock(callbacks_);
  const InCallback mark(callback_thread_);
  if (event_callback_) event_callback_(event);
}

void Client::Engine::on_payload_receipt(PayloadReceipt receipt) {
  if (payloads_) payloads_->receive(receipt);
}

void Client::Engine::on_reply(Reply reply) {
  {
    const std::lock_guard lock(mutex_);
    const auto waiting = replies_.find(reply.key.number);
    if (waiting == replies_.end()) return;  // nobody waits any more
    waiting->second = std::move(reply);
  }
  arrived_.notify_all();
}

void Client::Engine::on_tile_index(TileBlock block) {
  const std::lock_guard lock(callbacks_);
  if (maps_) tell_of_map(maps_->take(block));
}

void Client::Engine::on_tiles(TileAnswer answer) {
  if (!maps_) return;
  std::optional<Error> fault;
  {
    const std::lock_guard lock(callbacks_);
    const Result<MapChange> change = maps_->take(answer);
    if (change)
      tell_of_map(*change);
    else
      fault = change.error();
  }
  if (fault) tell(std::move(*fault));
}

void Client::Engine::prune_maps() {
  const std::lock_guard lock(callbacks_);
  for (const MapChange& change : maps_->prune()) tell_of_map(change);
}

void Client::Engine::tell_of_map(const MapChange& change) {
  const InCallback mark(callback_thread_);
  if (map_callback_ && !(change.changed.empty() && change.gone.empty())) map_callback_(change);
}

void Client::Engine::on_trouble(Error error) { tell(std::move(error)); }

void Client::Engine::tell(Error error) {
  const std::lock_guard lock(callbacks_);
  if (!trouble_callback_) {
    std::fprintf(stderr, "cairn client: %s\n", error.to_string().c_str());
    return;
  }
  const InCallback mark(callback_thread_);
  trouble_callback_(error);
}

void Client::Engine::tell_refusal(const Receipt& receipt) {
  const std::lock_guard lock(callbacks_);
  const InCallback mark(callback_thread_);
  if (refusal_callback_) refusal_callback_(receipt);
}

Result<void> Client::Engine::wait(const Revision& revision, Revision EstimateRevisions::*which,
                                  std::chrono::milliseconds timeout) {
  if (in_callback())
    return Error{ErrorCode::kUsage, "a callback may not wait: poses arrive on its thread"};
  Lock lock(mutex_);
  const auto here = [&] {
    return estimate_ &&
           ((*estimate_).graph.store != revision.store || (*estimate_).graph.era > revision.era ||
            reaches((*estimate_).*which, revision));
  };
  if (!arrived_.wait_for(lock, timeout, here))
    return Error{ErrorCode::kUnreachable, "no estimate of revision " + to_string(revision) +
                                              " within " + std::to_string(timeout.count()) + " ms"};
  if (estimate_->graph.store == revision.store && estimate_->graph.era == revision.era) return {};
  return Error{ErrorCode::kNotUsable, "the daemon's store is now " + to_string(estimate_->graph) +
                                          ": revision " + to_string(revision) +
                                          " is of before; wait for a new receipt"};
}

Result<std::string> Client::Engine::command(const std::string& text,
                                            std::chrono::milliseconds timeout) {
  if (in_callback())
    return Error{ErrorCode::kUsage, "a callback may not wait: replies arrive on its thread"};
  const auto end = std::chrono::steady_clock::now() + timeout;
  Command command{.key = {.client = identity_.writer, .number = 0}, .text = text};
  {
    const std::lock_guard lock(mutex_);
    command.key.number = ++commands_;
    replies_[command.key.number].reset();
  }
  // A daemon that was killed seems to listen until its lease ends, and its successor has not heard:
  // ask again now and then. Commands are idempotent by their key.
  constexpr std::chrono::milliseconds kAskAgain{1000};
  Lock lock(mutex_);
  const auto answered = [&] { return replies_[command.key.number].has_value(); };
  Result<void> sent;
  bool in_time = false;
  do {
    lock.unlock();
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    sent = link_->send(command, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    lock.lock();
    in_time =
        sent && arrived_.wait_until(
                    lock, std::min(end, std::chrono::steady_clock::now() + kAskAgain), answered);
  } while (sent && !in_time && std::chrono::steady_clock::now() < end);
  const std::optional<Reply> reply = std::move(replies_[command.key.number]);
  replies_.erase(command.key.number);
  if (!sent) return sent.error();
  if (!in_time)
    return Error{ErrorCode::kUnreachable, "the daemon did not answer \"" + text + "\" within " +
                                              std::to_string(timeout.count()) + " ms"};
  if (reply->error) return Error{*reply->error, reply->text};
  return reply->text;
}

void Client::Engine::watch_poses(std::function<void(const PoseUpdate&)> callback) {
  const std::lock_guard lock(callbacks_);
  pose_callback_ = std::move(callback);
  const InCallback mark(callback_thread_);
  if (pose_callback_ && pose_revisions_)
    pose_callback_({*pose_revisions_, all_of<PoseChunk>(poses_)});
}

void Client::Engine::watch_landmarks(
    std::function<void(const EstimateRevisions&, const std::vector<LandmarkChunk>&)> callback) {
  const std::lock_guard lock(callbacks_);
  landmark_callback_ = std::move(callback);
  const InCallback mark(callback_thread_);
  if (landmark_callback_ && landmark_revisions_)
    landmark_callback_(*landmark_revisions_, all_of<LandmarkChunk>(landmarks_));
}

void Client::Engine::watch_corrections(std::function<void(const Correction&)> callback) {
  const std::lock_guard lock(callbacks_);
  correction_callback_ = std::move(callback);
  const InCallback mark(callback_thread_);
  if (correction_callback_)
    for (const auto& [frame, correction] : corrections_) correction_callback_(correction);
}

void Client::Engine::watch_maps(std::function<void(const MapChange&)> callback) {
  const std::lock_guard lock(callbacks_);
  map_callback_ = std::move(callback);
  if (!map_callback_) return;
  for (MapView& view : maps())
    tell_of_map({view.map, view.estimate, view.resolution_m, std::move(view.tiles), {}});
}

std::vector<MapView> Client::Engine::maps() const {
  return maps_ ? maps_->views() : std::vector<MapView>();
}

void Client::Engine::look_at_map_from(double x_m, double y_m) {
  if (maps_) maps_->look_from(x_m, y_m);
}

void Client::Engine::watch_status(std::function<void(const Status&)> callback) {
  const std::lock_guard lock(callbacks_);
  status_callback_ = std::move(callback);
  const InCallback mark(callback_thread_);
  if (status_callback_ && status_) status_callback_(*status_);
}

void Client::Engine::watch_events(std::function<void(const Event&)> callback) {
  const std::lock_guard lock(callbacks_);
  event_callback_ = std::move(callback);
}

void Client::Engine::watch_refusals(std::function<void(const Receipt&)> callback) {
  const std::lock_guard lock(callbacks_);
  refusal_callback_ = std::move(callback);
}

void Client::Engine::watch_trouble(std::function<void(const Error&)> callback) {
  const std::lock_guard lock(callbacks_);
  trouble_callback_ = std::move(callback);
}

}  // namespace cairn
