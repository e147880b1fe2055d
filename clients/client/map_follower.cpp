// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/map_follower.hpp"

#include <algorithm>
#include <utility>

namespace cairn {

void MapFollower::start() {
  thread_ = std::thread([this] { run(); });
}

void MapFollower::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

MapChange MapFollower::take(const TileBlock& block) {
  const std::lock_guard lock(mutex_);
  // Another daemon: the one that was asked does not answer any more.
  if (block.run != asked_run_) ask_at_ = std::min(ask_at_, Clock::now());
  news_ = true;
  prune_at_ = Clock::now() + options_.quiet;
  changed_.notify_all();
  return copy_.take(block);
}

Result<MapChange> MapFollower::take(const TileAnswer& answer) {
  const std::lock_guard lock(mutex_);
  // What was refused is asked again as late as what nobody has answered.
  if (answer.number == asked_ && !answer.error) {
    unanswered_ = 0;
    ask_at_ = Clock::now() + options_.pause;
  }
  changed_.notify_all();
  if (answer.error == ErrorCode::kBadInput)
    return Error{ErrorCode::kBadInput, "the daemon refuses a request for tiles: " + answer.reason};
  return copy_.take(answer);
}

std::vector<MapChange> MapFollower::prune() {
  const std::lock_guard lock(mutex_);
  return copy_.prune();
}

void MapFollower::look_from(double x_m, double y_m) {
  const std::lock_guard lock(mutex_);
  x_m_ = x_m;
  y_m_ = y_m;
}

std::vector<MapView> MapFollower::views() const {
  const std::lock_guard lock(mutex_);
  return copy_.views();
}

void MapFollower::run() {
  Lock lock(mutex_);
  while (!stopping_) {
    if (news_ && Clock::now() >= ask_at_) {
      ask(lock);
    } else if (prune_at_ && !news_ && Clock::now() >= *prune_at_) {
      prune_at_.reset();
      lock.unlock();
      calls_.prune_now();
      lock.lock();
    } else if (news_) {
      changed_.wait_until(lock, ask_at_);
    } else if (prune_at_) {
      changed_.wait_until(lock, *prune_at_);
    } else {
      changed_.wait(lock);
    }
  }
}

void MapFollower::ask(Lock& lock) {
  auto request = copy_.next_request(x_m_, y_m_, options_.budget_bytes);
  news_ = request.has_value();
  if (!request) return;
  request->client = client_;
  request->number = ++asked_;
  asked_run_ = request->run;
  ask_at_ = Clock::now() + options_.patience * (1 << std::min(unanswered_++, 4));
  lock.unlock();
  const auto sent = link_.send(*request);
  if (!sent) calls_.tell(sent.error());
  lock.lock();
}

}  // namespace cairn
