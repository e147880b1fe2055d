// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "idl/link.hpp"
#include "server/transport.hpp"

namespace cairn::test {

/// Things that arrive on one thread and are waited for on another.
template <class T>
class Inbox {
 public:
  void add(T value) {
    {
      const std::lock_guard lock(mutex_);
      values_.push_back(std::move(value));
    }
    changed_.notify_all();
  }
  /// Everything, once there are `count`; what there is after ten seconds.
  std::vector<T> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(10), [&] { return values_.size() >= count; });
    return values_;
  }
  std::vector<T> all() {
    const std::lock_guard lock(mutex_);
    return values_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> values_;
};

struct RecordingDaemon : TransportListener {
  Inbox<std::pair<Transaction, Sender>> transactions;
  Inbox<UnreadableTransaction> unreadable;
  Inbox<std::pair<ClientState, Sender>> clients;
  Inbox<std::pair<std::string, Sender>> lost;
  Inbox<Payload> payloads;
  Inbox<Command> commands;
  Inbox<Status> rivals;
  Inbox<std::string> troubles;

  void on_transaction(Transaction transaction, const Sender& sender) override {
    transactions.add({std::move(transaction), sender});
  }
  void on_unreadable_transaction(UnreadableTransaction transaction,
                                 const Sender& /*sender*/) override {
    unreadable.add(std::move(transaction));
  }
  void on_client(ClientState client, const Sender& sender) override {
    clients.add({std::move(client), sender});
  }
  void on_source_lost(std::string source, const Sender& sender) override {
    lost.add({std::move(source), sender});
  }
  void on_payload(Payload payload, const Sender& /*sender*/) override {
    payloads.add(std::move(payload));
  }
  void on_unreadable_payload(Payload payload, std::string reason,
                             const Sender& /*sender*/) override {
    troubles.add(payload.source + ": " + reason);
  }
  void on_command(Command command) override { commands.add(std::move(command)); }
  void on_rival(Status rival) override { rivals.add(std::move(rival)); }
  void on_trouble(Error error) override { troubles.add(error.to_string()); }
};

struct RecordingClient : LinkListener {
  Inbox<Receipt> receipts;
  Inbox<SourceState> source_states;
  Inbox<PayloadReceipt> payload_receipts;
  Inbox<std::pair<EstimateRevisions, std::vector<PoseChunk>>> poses;
  Inbox<std::pair<EstimateRevisions, std::vector<LandmarkChunk>>> landmarks;
  Inbox<Correction> corrections;
  Inbox<Status> statuses;
  Inbox<Event> events;
  Inbox<Reply> replies;
  Inbox<std::string> troubles;

  void on_receipt(Receipt receipt) override { receipts.add(std::move(receipt)); }
  void on_source_state(SourceState state) override { source_states.add(std::move(state)); }
  void on_payload_receipt(PayloadReceipt receipt) override {
    payload_receipts.add(std::move(receipt));
  }
  void on_poses(EstimateRevisions revisions, std::vector<PoseChunk> chunks) override {
    poses.add({revisions, std::move(chunks)});
  }
  void on_landmarks(EstimateRevisions revisions, std::vector<LandmarkChunk> chunks) override {
    landmarks.add({revisions, std::move(chunks)});
  }
  void on_correction(Correction correction) override { corrections.add(std::move(correction)); }
  void on_status(Status status) override { statuses.add(std::move(status)); }
  void on_event(Event event) override { events.add(std::move(event)); }
  void on_reply(Reply reply) override { replies.add(std::move(reply)); }
  void on_trouble(Error error) override { troubles.add(error.to_string()); }
};

}  // namespace cairn::test
