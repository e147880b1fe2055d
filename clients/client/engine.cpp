// SPDX-License-Identifier: BSD-3-Clause
// The way out: from submit() through the spool and the window to the daemon, and receipts back.
#include "clients/client/engine.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "cairn/core/wall_clock.hpp"
#include "idl/limits.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kBatch = 1024;  // transactions that share one sync of the disk
constexpr auto kTellDaemon = 200ms;   // between states of this client
constexpr auto kHeartbeat = 5s;       // at least so often, for the clocks

std::uint64_t random_number() {
  std::random_device random;
  return std::uint64_t{random()} << 32 | random();
}

}  // namespace

Client::Engine::Engine(const ClientOptions& options, std::optional<ClientSpools> spools,
                       const MakeLink& make_link)
    : options_(options),
      identity_{.source = options.source,
                .epoch = spools ? spools->transactions.epoch() : 0,
                .writer = random_number(),
                .follows_maps = options.follow_maps},
      link_(make_link(identity_)),
      spool_(spools ? std::optional(std::move(spools->transactions)) : std::nullopt),
      outgoing_(spool_ ? spool_->next_sequence() : 1, {options.retry_first, options.retry_most}) {
  if (options.follow_maps)
    maps_ = std::make_unique<MapFollower>(
        *link_, identity_.writer, options.maps,
        MapFollower::Calls{.prune_now = [this] { prune_maps(); },
                           .tell = [this](Error error) { tell(std::move(error)); }});
  if (!spool_) return;
  payloads_ = std::make_unique<PayloadSender>(std::move(spools->payloads), identity_, *link_,
                                              [this](Error error) { tell(std::move(error)); });
  first_of_run_ = next_sequence_ = spool_->next_sequence();
  last_spooled_ = next_sequence_ - 1;
  oldest_kept_ = spool_->oldest_kept();
  spool_bytes_ = spool_->bytes();
  promise_ = remembered_ = spool_->promise();
}

Result<void> Client::Engine::start() {
  if (auto started = link_->start(*this); !started) return started;
  if (maps_) maps_->start();
  if (!spool_) return {};
  tell_daemon();
  payloads_->start();
  worker_ = std::thread([this] { work(); });
  return {};
}

Client::Engine::~Engine() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_.notify_all();
  if (worker_.joinable()) worker_.join();
  if (payloads_) payloads_->stop();
  if (maps_) maps_->stop();
  link_->stop();
  for (auto& [sequence, handle] : waiting_)
    handle->finish(
        Error{ErrorCode::kUnreachable, "the client was closed; the transaction is in its spool"});
}

Result<Client::Engine::Handle> Client::Engine::submit(Transaction transaction) {
  if (identity_.source.empty())
    return Error{ErrorCode::kUsage, "connect with a source to submit transactions"};
  auto handle = std::make_shared<Submission::State>();
  const std::lock_guard lock(mutex_);
  transaction.key = {
      .source = identity_.source, .epoch = identity_.epoch, .sequence = next_sequence_};
  transaction.sent_ns = wall_clock_ns();
  if (auto ok = limits::check(transaction); !ok) return ok.error();
  std::string bytes = encode(transaction);
  if (auto ok = limits::check_size(bytes); !ok) return ok.error();
  const std::uint64_t size = Spool::bytes_of(bytes);
  if (spool_bytes_ + taken_bytes_ + size > options_.spool_most_bytes)
    return Error{ErrorCode::kNotUsable,
                 "spool full: " + std::to_string(spool_bytes_ + taken_bytes_) + " of " +
                     std::to_string(options_.spool_most_bytes) +
                     " bytes wait for the daemon; is it running?",
                 identity_.source};
  handle->key = transaction.key;
  ++next_sequence_;
  taken_bytes_ += size;
  taken_.push_back({std::move(bytes), handle});
  work_.notify_one();
  return handle;
}

std::uint64_t Client::Engine::next_sequence() const {
  const std::lock_guard lock(mutex_);
  return next_sequence_;
}

Result<ContentHash> Client::Engine::send_payload(const std::string& type,
                                                 const std::string& bytes) {
  if (!payloads_) return Error{ErrorCode::kUsage, "connect with a source to send payloads"};
  return payloads_->take(type, bytes);
}

std::uint64_t Client::Engine::unstored_payloads() const {
  return payloads_ ? payloads_->waiting() : 0;
}

std::uint64_t Client::Engine::undecided() const {
  const std::lock_guard lock(mutex_);
  // Before a daemon has told how far it is, what the spool keeps may be undecided.
  return next_sequence_ - 1 - (daemon_ ? outgoing_.decided() : oldest_kept_ - 1);
}

bool Client::Engine::has_work(Outgoing::Clock::time_point now) const {
  if (stopping_ || !taken_.empty()) return true;
  if (!daemon_) return false;
  if ((!damaged_ && outgoing_.next(last_spooled_)) || released_ < daemon_->highest_decided)
    return true;
  if (now >= next_telling()) return true;
  const auto retry = outgoing_.next_retry();
  return retry && *retry <= now;
}

void Client::Engine::wait_for_work(Lock& lock) {
  while (!has_work(Outgoing::Clock::now())) {
    if (!daemon_) {
      work_.wait(lock);
      continue;
    }
    const auto tell = next_telling();
    work_.wait_until(lock, std::min(outgoing_.next_retry().value_or(tell), tell));
  }
}

void Client::Engine::work() {
  Lock lock(mutex_);
  for (;;) {
    wait_for_work(lock);
    if (!taken_.empty()) spool_taken(lock);
    if (stopping_ && taken_.empty()) return remember_promise(lock);
    if (!daemon_) continue;
    // Before transactions: what we were promised may tell the daemon that its store lost its end.
    if (Outgoing::Clock::now() >= next_telling()) {
      lock.unlock();
      tell_daemon();
      lock.lock();
      remember_promise(lock);
    }
    send_due();
    send_next(lock);
    if (daemon_ && released_ < daemon_->highest_decided) {
      released_ = daemon_->highest_decided;
      spool_->release(released_);
      oldest_kept_ = spool_->oldest_kept();
      spool_bytes_ = spool_->bytes();
    }
  }
}

// All that has piled up goes to disk with one sync.
void Client::Engine::spool_taken(Lock& lock) {
  std::vector<std::string> records;
  std::vector<Handle> handles;
  std::uint64_t size = 0;
  while (!taken_.empty() && records.size() < kBatch) {
    size += Spool::bytes_of(taken_.front().bytes);
    records.push_back(std::move(taken_.front().bytes));
    handles.push_back(std::move(taken_.front().handle));
    taken_.pop_front();
  }
  lock.unlock();
  const auto appended = spool_->append(records);
  lock.lock();
  if (!appended) return fail_taken(handles, appended.error());
  taken_bytes_ -= size;
  spool_bytes_ = spool_->bytes();
  last_spooled_ += handles.size();
  for (Handle& handle : handles) {
    const std::uint64_t sequence = handle->key.sequence;
    waiting_[sequence] = std::move(handle);
  }
}

// Their numbers were not used: the next submission gets the first of them.
void Client::Engine::fail_taken(const std::vector<Handle>& batch, const Error& error) {
  for (const Handle& handle : batch) handle->finish(error);
  for (const Taken& taken : taken_) taken.handle->finish(error);
  taken_.clear();
  taken_bytes_ = 0;
  next_sequence_ = last_spooled_ + 1;
}

// Fills the window, but lets new submissions reach the disk in between.
void Client::Engine::send_next(Lock& lock) {
  constexpr int kAtLeast = 32;  // or a steady stream of submissions would keep all from being sent
  for (int sent_now = 0; (taken_.empty() || sent_now < kAtLeast) && !stopping_ && !damaged_;
       ++sent_now) {
    const auto sequence = outgoing_.next(last_spooled_);
    if (!sequence) return;
    auto record = spool_->read(*sequence);
    auto transaction = record ? decode_transaction(*record) : Result<Transaction>(record.error());
    damaged_ = !transaction;  // nothing can be sent in order any more
    const auto sent = transaction ? link_->send(*transaction) : Result<void>(transaction.error());
    if (transaction) outgoing_.sent(std::move(*transaction), Outgoing::Clock::now());
    if (sent) continue;
    outgoing_.postpone(*sequence, Outgoing::Clock::now());
    lock.unlock();
    tell(sent.error());
    lock.lock();
    return;
  }
}

void Client::Engine::send_due() {
  const auto now = Outgoing::Clock::now();
  for (const Transaction* transaction : outgoing_.due(now))
    if (!link_->send(*transaction)) outgoing_.postpone(transaction->key.sequence, now);
}

// For the next run: a store that loses its end meanwhile is found out by it.
void Client::Engine::remember_promise(Lock& lock) {
  if (remembered_ == promise_) return;
  remembered_ = promise_;
  lock.unlock();
  spool_->remember(remembered_);
  lock.lock();
}

Outgoing::Clock::time_point Client::Engine::next_telling() const {
  return told_daemon_ + (news_for_daemon_ ? kTellDaemon : kHeartbeat);
}

void Client::Engine::tell_daemon() {
  ClientState state{.source = identity_.source, .epoch = identity_.epoch, .robot = options_.robot};
  {
    const std::lock_guard lock(mutex_);
    told_daemon_ = Outgoing::Clock::now();
    news_for_daemon_ = false;
    state.highest_decided = promise_.sequence;
    state.receipted = promise_.revision;
    state.oldest_kept = oldest_kept_;
    if (daemon_) state.daemon_ns = daemon_->daemon_ns;
  }
  state.sent_ns = wall_clock_ns();
  if (auto sent = link_->send(state); !sent) tell(sent.error());
}

void Client::Engine::on_receipt(Receipt receipt) {
  const bool final = Outgoing::is_final(receipt);
  bool usurped = false;
  Handle handle;
  {
    const std::lock_guard lock(mutex_);
    if (outgoing_.receive(receipt, Outgoing::Clock::now())) {
      foreign_ = false;
      // Both of one receipt: while a store is refilled, earlier sequences get later revisions.
      if (promise_.revision.store != receipt.revision.store ||
          receipt.key.sequence >= promise_.sequence)
        promise_ = {.revision = receipt.revision, .sequence = receipt.key.sequence};
      news_for_daemon_ = true;
    }
    if (receipt.refusal == RefusalCode::kForeignSource) usurped = !std::exchange(foreign_, true);
    if (auto waiting = final ? waiting_.extract(receipt.key.sequence) : Waiting::node_type())
      handle = std::move(waiting.mapped());
  }
  work_.notify_one();
  if (usurped)
    tell(Error{ErrorCode::kNotUsable,
               "another program lives under this source name; end it, or take another name: until "
               "then submissions wait in the spool",
               identity_.source});
  if (handle)
    handle->finish(std::move(receipt));
  else if (final && receipt.refusal)
    tell_refusal(receipt);
}

void Client::Engine::on_source_state(SourceState state) {
  std::optional<Error> loss;
  bool new_daemon = false;
  {
    const std::lock_guard lock(mutex_);
    const bool first = !daemon_;
    const bool other_store = daemon_ && (daemon_->revision.store != state.revision.store ||
                                         daemon_->revision.era != state.revision.era);
    new_daemon = !daemon_ || daemon_->daemon_ns != state.daemon_ns;
    if (new_daemon) {
      news_for_daemon_ = true;
      told_daemon_ = {};
    }
    // A new run is held to every receipt, of which the last state may not have known yet.
    const bool lower = daemon_ && (state.highest_decided < daemon_->highest_decided ||
                                   (new_daemon && state.highest_decided < promise_.sequence));
    if (first || other_store || lower) {
      // What this run has submitted is sent even if the daemon knows the number: a spool that lost
      // its end, or an old copy of one, is answered with conflicts and not with silence.
      std::uint64_t decided = state.highest_decided;
      if (first) decided = std::min(decided, first_of_run_ - 1);
      if (decided + 1 < oldest_kept_) {
        loss = Error{ErrorCode::kNotUsable,
                     "the daemon lost sequences " + std::to_string(decided + 1) + " to " +
                         std::to_string(oldest_kept_ - 1) +
                         ", which the spool no longer keeps; restore a backup of its data folder",
                     identity_.source};
        decided = oldest_kept_ - 1;
      }
      outgoing_.rewind(decided);
      damaged_ = false;  // perhaps this daemon does not need that record
      released_ = std::min(released_, state.highest_decided);
    }
    daemon_ = std::move(state);
  }
  work_.notify_one();
  if (new_daemon) payloads_->meet_daemon();
  if (loss) tell(std::move(*loss));
}

}  // namespace cairn
