// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/transport.hpp"

namespace cairn::test {

/// What survives a restart of the fake daemon.
struct FakeStore {
  using Source = std::pair<std::string, std::uint64_t>;
  Revision head{.store = 9, .era = 0, .number = 0};
  std::int64_t runs = 0;                                   // of daemons on it
  std::map<Source, std::vector<Receipt>> decided;          // by sequence, from 1
  std::set<std::pair<TransactionKey, Revision>> promised;  // by receipts, also of lost ones
  int claims_never_promised = 0;                           // of clients
};

/// The shortest daemon that keeps the wire's promises: decides each source's sequences in order,
/// once. Calls come from the transport's thread and from the test.
class FakeDaemon : public TransportListener {
 public:
  using Policy = std::function<std::optional<RefusalCode>(const Transaction&)>;

  FakeDaemon(std::unique_ptr<Transport> transport, FakeStore& store)
      : transport_(std::move(transport)), store_(store), run_(++store.runs) {}
  ~FakeDaemon() override { transport_->stop(); }
  [[nodiscard]] bool start() { return transport_->start(*this).ok(); }

  void decide_by(Policy policy) {
    const std::lock_guard lock(mutex_);
    policy_ = std::move(policy);
  }
  /// Before start(): transactions pile up until resume().
  void pause() { paused_ = true; }
  void resume() {
    const std::lock_guard lock(mutex_);
    paused_ = false;
    for (auto& [source, held] : held_) decide_held(source);
  }
  /// Before start(): decides, but tells its state only to clients that ask.
  void tell_no_marks() { tells_marks_ = false; }
  /// Forgets what was decided after `sequence`, as a damaged store does.
  void lose_tail(std::uint64_t sequence) {
    const std::lock_guard lock(mutex_);
    ++store_.head.era;
    for (auto& [source, receipts] : store_.decided) {
      receipts.resize(std::min<std::size_t>(receipts.size(), sequence));
      publish_state(source);
    }
  }
  /// True once this many transactions of all sources are decided; false after ten seconds.
  bool wait_decided(std::size_t count) {
    return wait([this, count] {
      std::size_t sum = 0;
      for (const auto& [source, receipts] : store_.decided) sum += receipts.size();
      return sum >= count;
    });
  }
  bool wait_held(std::size_t count) {
    return wait([this, count] {
      std::size_t sum = 0;
      for (const auto& [source, held] : held_) sum += held.size();
      return sum >= count;
    });
  }
  bool wait_lost() {
    return wait([this] { return lost_ > 0; });
  }
  std::size_t held() {
    const std::lock_guard lock(mutex_);
    std::size_t sum = 0;
    for (const auto& [source, held] : held_) sum += held.size();
    return sum;
  }
  Transport& transport() { return *transport_; }

  void on_transaction(Transaction transaction, const Sender& /*sender*/) override {
    const std::lock_guard lock(mutex_);
    const FakeStore::Source source{transaction.key.source, transaction.key.epoch};
    const auto& receipts = store_.decided[source];
    if (transaction.key.sequence <= receipts.size()) {
      transport_->publish_receipts({receipts[transaction.key.sequence - 1]});
      return;
    }
    const std::uint64_t sequence = transaction.key.sequence;
    held_[source].insert_or_assign(sequence, std::move(transaction));
    if (!paused_) decide_held(source);
    changed_.notify_all();
  }
  void on_unreadable_transaction(UnreadableTransaction, const Sender&) override {}
  void on_client(ClientState client, const Sender& /*sender*/) override {
    const std::lock_guard lock(mutex_);
    if (client.highest_decided > 0 &&
        !store_.promised.contains(
            {{client.source, client.epoch, client.highest_decided}, client.receipted}))
      ++store_.claims_never_promised;
    publish_state({client.source, client.epoch});
  }
  void on_source_lost(std::string, const Sender&) override {
    const std::lock_guard lock(mutex_);
    ++lost_;
    changed_.notify_all();
  }
  void on_payload(Payload, const Sender&) override {}
  void on_unreadable_payload(Payload, std::string, const Sender&) override {}
  void on_command(Command command) override {
    const bool known = command.text == "ping";
    transport_->reply({.key = command.key,
                       .error = known ? std::nullopt : std::optional(ErrorCode::kUsage),
                       .text = known ? "pong" : "no such verb: " + command.text});
  }
  void on_rival(Status) override {}
  void on_trouble(Error) override {}

 private:
  void decide_held(const FakeStore::Source& source) {
    auto& receipts = store_.decided[source];
    auto& held = held_[source];
    for (auto next = held.find(receipts.size() + 1); next != held.end();
         next = held.find(receipts.size() + 1)) {
      Receipt receipt{.key = next->second.key, .revision = store_.head};
      receipt.refusal = policy_ ? policy_(next->second) : std::nullopt;
      held.erase(next);
      if (receipt.refusal &&
          (is_retryable(*receipt.refusal) || *receipt.refusal == RefusalCode::kForeignSource)) {
        transport_->publish_receipts({receipt});
        break;
      }
      receipt.revision.number = ++store_.head.number;
      receipts.push_back(receipt);
      store_.promised.emplace(receipt.key, receipt.revision);
      transport_->publish_receipts({receipt});
    }
    if (tells_marks_) publish_state(source);
    changed_.notify_all();
  }
  void publish_state(const FakeStore::Source& source) {
    transport_->publish(SourceState{.source = source.first,
                                    .epoch = source.second,
                                    .highest_decided = store_.decided[source].size(),
                                    .revision = store_.head,
                                    .daemon_ns = run_});
  }
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10), condition);
  }

  std::unique_ptr<Transport> transport_;
  FakeStore& store_;
  const std::int64_t run_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<FakeStore::Source, std::map<std::uint64_t, Transaction>> held_;
  Policy policy_;
  bool paused_ = false;
  bool tells_marks_ = true;
  int lost_ = 0;
};

}  // namespace cairn::test
