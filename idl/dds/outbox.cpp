// SPDX-License-Identifier: BSD-3-Clause
#include "idl/dds/outbox.hpp"

#include <chrono>

namespace cairn::dds {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPatience = std::chrono::seconds(15);  // longer than any lease that we ship
constexpr auto kFarewell = std::chrono::seconds(1);

}  // namespace

void Outbox::start(const TroubleHandler& trouble) {
  trouble_ = &trouble;
  thread_ = std::thread([this] { run(); });
}

void Outbox::stop() noexcept {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    give_up_ = Clock::now() + kFarewell;
  }
  changed_.notify_all();
  thread_.join();
}

void Outbox::push(std::size_t bytes, Write write) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    if (bytes_ + bytes <= kMostBytes) {
      bytes_ += bytes;
      queue_.push_back({bytes, std::move(write)});
      changed_.notify_all();
      return;
    }
  }
  (*trouble_)({ErrorCode::kUnreachable,
               "a reply or event is dropped: more than 256 MB wait for slow readers"});
}

void Outbox::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    const Item item = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    if (const auto code = write(item.write); code < 0)
      (*trouble_)(to_error(code, "a reply or event is dropped"));
    lock.lock();
    bytes_ -= item.bytes;
  }
}

dds_return_t Outbox::write(const Write& write) {
  const auto began = Clock::now();
  for (;;) {
    const auto code = write();
    if (code != DDS_RETCODE_TIMEOUT) return code;
    const std::lock_guard lock(mutex_);
    if (Clock::now() > (stopping_ ? give_up_ : began + kPatience)) return code;
  }
}

}  // namespace cairn::dds
