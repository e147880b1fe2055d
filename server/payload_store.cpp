// SPDX-License-Identifier: BSD-3-Clause
#include "server/payload_store.hpp"

#include "cairn/core/wall_clock.hpp"

namespace cairn {
namespace {

constexpr std::size_t kRemembered = 65'536;

}  // namespace

void PayloadStore::start() {
  thread_ = std::thread([this] { run(); });
}

void PayloadStore::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void PayloadStore::answer(const Payload& payload, PayloadAnswer answer, std::string reason) {
  transport_.publish(PayloadReceipt{payload.source, payload.epoch, payload.number, payload.hash,
                                    answer, std::move(reason)});
}

void PayloadStore::take(Payload payload) {
  {
    const std::lock_guard lock(mutex_);
    if (queued_bytes_ + payload.bytes.size() <= options_.queue_bytes) {
      queued_bytes_ += payload.bytes.size();
      queue_.push_back(std::move(payload));
      changed_.notify_all();
      return;
    }
  }
  answer(payload, PayloadAnswer::kBusy, "the daemon is behind with storing payloads");
}

void PayloadStore::expect(const Spool& spool, const ContentHash& hash) {
  const std::lock_guard lock(mutex_);
  if (stored_.contains(hash) || missing_.size() >= options_.missing) return;
  missing_.try_emplace(hash, Missing{spool, Clock::now() + options_.patience});
  if (missing_.size() == 1) changed_.notify_all();
}

void PayloadStore::forget(const Spool& spool) {
  const std::lock_guard lock(mutex_);
  std::erase_if(queue_, [&](const Payload& payload) {
    if (payload.source != spool.first || payload.epoch != spool.second) return false;
    queued_bytes_ -= payload.bytes.size();
    return true;
  });
  if (storing_ == spool) storing_.reset();
}

void PayloadStore::run() {
  Lock lock(mutex_);
  while (!stopping_) {
    if (queue_.empty()) {
      ask(lock);
      if (Clock::now() >= collect_at_) collect(lock);
      if (stopping_ || !queue_.empty()) continue;
      const auto pause = missing_.empty() ? std::chrono::milliseconds(60'000)
                                          : std::min(options_.patience, options_.ask_again) / 2;
      changed_.wait_until(lock, std::min(Clock::now() + pause, collect_at_));
      continue;
    }
    const Payload payload = std::move(queue_.front());
    queue_.pop_front();
    storing_.emplace(payload.source, payload.epoch);
    lock.unlock();
    store(payload);
    lock.lock();
    if (!std::exchange(storing_, {})) transport_.forget(payload.source, payload.epoch);
    queued_bytes_ -= payload.bytes.size();
  }
}

void PayloadStore::store(const Payload& payload) {
  if (const ContentHash found = content_hash(payload.bytes); found != payload.hash)
    return answer(
        payload, PayloadAnswer::kRefused,
        "the bytes have the hash " + to_string(found) + ", not " + to_string(payload.hash));
  if (const auto stored = journal_.put_payload(payload.bytes); !stored)
    return answer(payload, PayloadAnswer::kBusy, stored.error().to_string());
  {
    const std::lock_guard lock(mutex_);
    missing_.erase(payload.hash);
    if (stored_.size() >= kRemembered) stored_.clear();
    stored_.insert(payload.hash);
  }
  if (tell_stored_) tell_stored_();
  answer(payload, PayloadAnswer::kStored);
}

void PayloadStore::collect(Lock& lock) {
  collect_at_ = Clock::now() + options_.collect_every;
  lock.unlock();
  const std::int64_t kept_from =
      wall_clock_ns() - std::chrono::nanoseconds(options_.keep_unnamed).count();
  const auto collected = journal_.collect_payloads(kept_from, [this] { return !stopping_; });
  if (!collected && !stopping_)
    tell_(Severity::kWarning, "payloads were not collected: " + collected.error().to_string());
  if (collected && *collected > 0)
    tell_(Severity::kInfo,
          std::to_string(*collected) + " payloads deleted that no transaction has named for " +
              std::to_string(options_.keep_unnamed / std::chrono::hours(24)) + " days");
  lock.lock();
}

void PayloadStore::ask(Lock& lock) {
  const auto now = Clock::now();
  std::map<ContentHash, Spool> due;
  for (auto& [hash, missing] : missing_) {
    if (missing.ask_at > now) continue;
    missing.ask_at = now + options_.ask_again;
    ++missing.questions;
    due[hash] = missing.spool;
  }
  lock.unlock();
  std::set<ContentHash> here;
  for (const auto& [hash, spool] : due) {
    if (journal_.has_payload(hash))
      here.insert(hash);
    else
      transport_.publish(
          PayloadReceipt{spool.first, spool.second, 0, hash, PayloadAnswer::kWanted, ""});
  }
  lock.lock();
  std::erase_if(missing_, [&](const auto& entry) {
    return here.contains(entry.first) || entry.second.questions >= options_.questions;
  });
}

}  // namespace cairn
