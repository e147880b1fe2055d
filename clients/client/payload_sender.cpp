// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/payload_sender.hpp"

#include <algorithm>

#include "idl/convert.hpp"
#include "idl/limits.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

// A payload that nobody answers, because the daemon has ended or is busy, is sent again.
std::chrono::milliseconds pause_after(int attempts) {
  return std::min<std::chrono::milliseconds>(1000ms * (1 << std::min(attempts, 5)), 30'000ms);
}

}  // namespace

void PayloadSender::start() {
  thread_ = std::thread([this] { run(); });
}

void PayloadSender::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Result<ContentHash> PayloadSender::take(const std::string& type, const std::string& bytes) {
  if (type.empty() || type.size() > limits::kWord || type.find('\n') != std::string::npos ||
      type.find('\0') != std::string::npos)
    return Error{ErrorCode::kBadInput, "the payload's type has " + std::to_string(type.size()) +
                                           " bytes; expected one line of 1 to " +
                                           std::to_string(limits::kWord)};
  if (auto ok = limits::check_count("payload", bytes.size(), kMaxPayloadBytes); !ok)
    return ok.error();
  const std::lock_guard lock(mutex_);
  if (const auto number = spool_.append(type, bytes); !number) return number.error();
  changed_.notify_all();
  return content_hash(bytes);
}

void PayloadSender::meet_daemon() {
  const std::lock_guard lock(mutex_);
  daemon_is_there_ = true;
  flights_.clear();
  changed_.notify_all();
}

void PayloadSender::receive(const PayloadReceipt& receipt) {
  std::optional<Error> refusal;
  {
    const std::lock_guard lock(mutex_);
    const auto kept = std::find_if(spool_.kept().begin(), spool_.kept().end(), [&](const auto& k) {
      return k.second.hash == receipt.hash && (receipt.number == 0 || receipt.number == k.first);
    });
    if (kept == spool_.kept().end()) return;  // stored long ago
    const std::uint64_t number = kept->first;
    if (receipt.answer == PayloadAnswer::kWanted) {
      flights_[number].send_at = Clock::now();
    } else if (receipt.answer == PayloadAnswer::kBusy) {
      Flight& flight = flights_[number];
      flight.send_at = Clock::now() + pause_after(flight.attempts);
    } else {
      if (receipt.answer == PayloadAnswer::kRefused)
        refusal = Error{ErrorCode::kBadInput, "the daemon refuses payload " +
                                                  to_string(receipt.hash) + ": " + receipt.reason};
      spool_.remove(number);
      flights_.erase(number);
    }
  }
  changed_.notify_all();
  if (refusal) tell_(std::move(*refusal));
}

std::uint64_t PayloadSender::waiting() const {
  const std::lock_guard lock(mutex_);
  return spool_.kept().size();
}

// Slots are used again when what was in them is stored.
std::uint64_t PayloadSender::window_end() const {
  return spool_.kept().empty() ? 0 : spool_.kept().begin()->first + wire::kPayloadSlots;
}

void PayloadSender::run() {
  Lock lock(mutex_);
  while (!stopping_) {
    const auto now = Clock::now();
    auto next = Clock::time_point::max();
    std::optional<std::uint64_t> due;
    if (daemon_is_there_) {
      for (const auto& [number, kept] : spool_.kept()) {
        if (number >= window_end() || due) break;
        const Flight& flight = flights_[number];
        if (flight.send_at <= now)
          due = number;
        else
          next = std::min(next, flight.send_at);
      }
    }
    if (due)
      send(*due, lock);
    else if (next == Clock::time_point::max())
      changed_.wait(lock);
    else
      changed_.wait_until(lock, next);
  }
}

void PayloadSender::send(std::uint64_t number, Lock& lock) {
  Flight& flight = flights_[number];
  flight.send_at = Clock::now() + pause_after(flight.attempts++);
  auto content = spool_.read(number);
  Payload payload{.source = identity_.source,
                  .epoch = identity_.epoch,
                  .number = number,
                  .hash = spool_.kept().at(number).hash};
  if (!content) spool_.remove(number);  // nobody else has it
  lock.unlock();
  if (content) {
    payload.type = std::move(content->type);
    payload.bytes = std::move(content->bytes);
  }
  const auto sent = content ? link_.send(payload) : Result<void>(content.error());
  if (!sent) tell_(sent.error());
  lock.lock();
}

}  // namespace cairn
