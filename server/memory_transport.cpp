// SPDX-License-Identifier: BSD-3-Clause
#include "server/memory_transport.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include "cairn/core/wall_clock.hpp"
#include "idl/convert.hpp"

namespace cairn {
namespace {

// Runs what is posted, in order, on a thread of its own.
class Mailbox {
 public:
  using Task = std::function<void()>;
  ~Mailbox() { stop(); }
  void start() {
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  void post(Task task) {
    {
      const std::lock_guard lock(mutex_);
      if (stopped_) return;
      tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return stopped_ || !tasks_.empty(); });
      if (stopped_) return;
      const Task task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool stopped_ = false;
  std::thread thread_;
};

// What is kept for late joiners, by topic and key, in the order of the first writing.
using InstanceKey = std::tuple<std::string, std::string, std::uint64_t, std::uint64_t>;

class MemoryLink;
class MemoryTransport;

}  // namespace

struct MemoryNetwork::State {
  std::mutex mutex;  // taken before a mailbox's
  std::vector<MemoryTransport*> daemons;
  std::vector<MemoryLink*> links;
};

namespace {

using Network = std::shared_ptr<MemoryNetwork::State>;

class MemoryLink final : public Link {
 public:
  MemoryLink(Network network, Identity identity)
      : network_(std::move(network)), identity_(std::move(identity)) {}
  ~MemoryLink() override { stop(); }

  Result<void> start(LinkListener& listener) override;
  void stop() noexcept override;
  Result<void> send(const Transaction& transaction) override;
  Result<void> send(const ClientState& state) override;
  Result<void> send(const Payload& payload) override;
  Result<void> send(const TileRequest& request) override;
  Result<void> send(const Command& command, int timeout_ms) override;

  [[nodiscard]] const Identity& identity() const { return identity_; }
  void post(std::function<void(LinkListener&)> task) {
    mailbox_.post([this, task = std::move(task)] { task(*listener_); });
  }
  using Kept = std::map<InstanceKey, std::function<void(TransportListener&)>>;
  Kept kept;  // guarded by the network's mutex

 private:
  Result<void> send_to_daemons(const std::optional<InstanceKey>& key,
                               std::function<void(TransportListener&)> task);
  Sender sender() const { return {.writer = identity_.writer, .arrived_ns = wall_clock_ns()}; }

  Network network_;
  Identity identity_;
  LinkListener* listener_ = nullptr;
  Mailbox mailbox_;
};

class MemoryTransport final : public Transport {
 public:
  explicit MemoryTransport(Network network) : network_(std::move(network)) {}
  ~MemoryTransport() override { stop(); }

  Result<void> start(TransportListener& listener) override;
  void stop() noexcept override;

  void publish_receipts(const std::vector<Receipt>& receipts) override {
    for (const Receipt& receipt : receipts)
      send_to_source("receipt", receipt.key.source, receipt.key.epoch,
                     receipt.key.sequence % wire::kSlots,
                     [receipt](LinkListener& to) { to.on_receipt(receipt); });
  }
  void publish(const SourceState& state) override {
    send_to_source("source_state", state.source, state.epoch, 0,
                   [state](LinkListener& to) { to.on_source_state(state); });
  }
  void forget(const std::string& source, std::uint64_t epoch) override {
    const std::lock_guard lock(network_->mutex);
    std::erase_if(kept, [&](const auto& entry) {
      const auto& [topic, name, number, slot] = entry.first;
      return (topic == "receipt" || topic == "source_state") && name == source && number == epoch;
    });
  }
  void publish(const PayloadReceipt& receipt) override {
    send_to_source("", receipt.source, receipt.epoch, 0,
                   [receipt](LinkListener& to) { to.on_payload_receipt(receipt); });
  }
  void publish_poses(const EstimateRevisions& revisions,
                     const std::vector<PoseChunk>& chunks) override {
    publish_round("poses", revisions, chunks, &LinkListener::on_poses);
  }
  void publish_landmarks(const EstimateRevisions& revisions,
                         const std::vector<LandmarkChunk>& chunks) override {
    publish_round("landmarks", revisions, chunks, &LinkListener::on_landmarks);
  }
  void publish(const Correction& correction) override {
    send({"correction", correction.frame.robot, correction.frame.epoch, 0}, nullptr,
         [correction](LinkListener& to) { to.on_correction(correction); });
  }
  void publish_tile_index(const std::vector<TileBlock>& blocks) override {
    for (const TileBlock& block : blocks)
      send(
          {"tiles " + block.map, "", static_cast<std::uint32_t>(block.x),
           static_cast<std::uint32_t>(block.y)},
          [](const Link::Identity& to) { return to.follows_maps; },
          [block](LinkListener& to) { to.on_tile_index(block); });
  }
  void publish(const TileAnswer& answer) override {
    send(
        {}, [client = answer.client](const Link::Identity& to) { return to.writer == client; },
        [answer](LinkListener& to) { to.on_tiles(answer); });
  }
  void publish(const Status& status) override;
  void publish(const Event& event) override {
    send({}, nullptr, [event](LinkListener& to) { to.on_event(event); });
  }
  void reply(const Reply& reply) override {
    send(
        {}, [client = reply.key.client](const Link::Identity& to) { return to.writer == client; },
        [reply](LinkListener& to) { to.on_reply(reply); });
  }

  void post(std::function<void(TransportListener&)> task) {
    mailbox_.post([this, task = std::move(task)] { task(*listener_); });
  }
  using Wanted = std::function<bool(const Link::Identity&)>;
  struct KeptMessage {
    Wanted wanted;
    std::function<void(LinkListener&)> deliver;
  };
  std::map<InstanceKey, KeptMessage> kept;  // guarded by the network's mutex

 private:
  // Kept unless the key's topic is empty.
  void send(const InstanceKey& key, Wanted wanted, std::function<void(LinkListener&)> deliver);
  void send_to_source(const char* topic, const std::string& source, std::uint64_t epoch,
                      std::uint64_t slot, std::function<void(LinkListener&)> deliver) {
    send(
        {topic, source, epoch, slot},
        [source, epoch](const Link::Identity& to) {
          return to.source == source && to.epoch == epoch;
        },
        std::move(deliver));
  }
  template <class Chunk>
  void publish_round(const char* topic, const EstimateRevisions& revisions,
                     const std::vector<Chunk>& chunks,
                     void (LinkListener::*deliver)(EstimateRevisions, std::vector<Chunk>));

  Network network_;
  TransportListener* listener_ = nullptr;
  Mailbox mailbox_;
};

Result<void> MemoryLink::start(LinkListener& listener) {
  listener_ = &listener;
  const std::lock_guard lock(network_->mutex);
  for (MemoryTransport* daemon : network_->daemons)
    for (const auto& [key, message] : daemon->kept)
      if (!message.wanted || message.wanted(identity_)) post(message.deliver);
  network_->links.push_back(this);
  mailbox_.start();
  return {};
}

void MemoryLink::stop() noexcept {
  {
    const std::lock_guard lock(network_->mutex);
    if (std::erase(network_->links, this) == 0) return;
    kept.clear();
    for (MemoryTransport* daemon : network_->daemons)
      if (!identity_.source.empty())
        daemon->post([source = identity_.source, sender = sender()](TransportListener& to) {
          to.on_source_lost(source, sender);
        });
  }
  mailbox_.stop();
}

Result<void> MemoryLink::send_to_daemons(const std::optional<InstanceKey>& key,
                                         std::function<void(TransportListener&)> task) {
  const std::lock_guard lock(network_->mutex);
  if (key) kept[*key] = task;
  for (MemoryTransport* daemon : network_->daemons) daemon->post(task);
  return {};
}

Result<void> MemoryLink::send(const Transaction& transaction) {
  return send_to_daemons(InstanceKey{"transaction", "", 0, transaction.key.sequence % wire::kSlots},
                         [transaction, sender = sender()](TransportListener& to) {
                           to.on_transaction(transaction, sender);
                         });
}
Result<void> MemoryLink::send(const ClientState& state) {
  return send_to_daemons(
      InstanceKey{"client_state", "", 0, 0},
      [state, sender = sender()](TransportListener& to) { to.on_client(state, sender); });
}
Result<void> MemoryLink::send(const Payload& payload) {
  return send_to_daemons(std::nullopt, [payload, sender = sender()](TransportListener& to) {
    to.on_payload(payload, sender);
  });
}
Result<void> MemoryLink::send(const TileRequest& request) {
  return send_to_daemons(std::nullopt,
                         [request](TransportListener& to) { to.on_tile_request(request); });
}
Result<void> MemoryLink::send(const Command& command, int /*timeout_ms*/) {
  {
    const std::lock_guard lock(network_->mutex);
    if (network_->daemons.empty()) return Error{ErrorCode::kUnreachable, "no daemon answers"};
  }
  return send_to_daemons(std::nullopt,
                         [command](TransportListener& to) { to.on_command(command); });
}

Result<void> MemoryTransport::start(TransportListener& listener) {
  listener_ = &listener;
  const std::lock_guard lock(network_->mutex);
  for (MemoryLink* link : network_->links)
    for (const auto& [key, deliver] : link->kept) post(deliver);
  network_->daemons.push_back(this);
  mailbox_.start();
  return {};
}

void MemoryTransport::stop() noexcept {
  {
    const std::lock_guard lock(network_->mutex);
    if (std::erase(network_->daemons, this) == 0) return;
    kept.clear();
  }
  mailbox_.stop();
}

void MemoryTransport::send(const InstanceKey& key, Wanted wanted,
                           std::function<void(LinkListener&)> deliver) {
  const std::lock_guard lock(network_->mutex);
  if (std::find(network_->daemons.begin(), network_->daemons.end(), this) ==
      network_->daemons.end())
    return;
  for (MemoryLink* link : network_->links)
    if (!wanted || wanted(link->identity())) link->post(deliver);
  if (!std::get<0>(key).empty()) kept[key] = {std::move(wanted), std::move(deliver)};
}

template <class Chunk>
void MemoryTransport::publish_round(const char* topic, const EstimateRevisions& revisions,
                                    const std::vector<Chunk>& chunks,
                                    void (LinkListener::*deliver)(EstimateRevisions,
                                                                  std::vector<Chunk>)) {
  send({}, nullptr,
       [revisions, chunks, deliver](LinkListener& to) { (to.*deliver)(revisions, chunks); });
  const std::lock_guard lock(network_->mutex);
  for (const Chunk& chunk : chunks)
    kept[{topic, chunk.frame.robot, chunk.frame.epoch, chunk.chunk}] = {
        nullptr,
        [revisions, chunk, deliver](LinkListener& to) { (to.*deliver)(revisions, {chunk}); }};
  kept[{std::string(topic) + "_end", "", 0, 0}] = {
      nullptr, [revisions, deliver](LinkListener& to) { (to.*deliver)(revisions, {}); }};
}

void MemoryTransport::publish(const Status& status) {
  send({"status", "", 0, 0}, nullptr, [status](LinkListener& to) { to.on_status(status); });
  const std::lock_guard lock(network_->mutex);
  for (MemoryTransport* daemon : network_->daemons)
    if (daemon != this) daemon->post([status](TransportListener& to) { to.on_rival(status); });
}

}  // namespace

MemoryNetwork::MemoryNetwork() : state_(std::make_shared<State>()) {}

std::unique_ptr<Transport> MemoryNetwork::make_transport() const {
  return std::make_unique<MemoryTransport>(state_);
}
std::unique_ptr<Link> MemoryNetwork::make_link(Link::Identity identity) const {
  return std::make_unique<MemoryLink>(state_, std::move(identity));
}

}  // namespace cairn
