// SPDX-License-Identifier: BSD-3-Clause
#include "server/dds_transport.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include "cairn/core/wall_clock.hpp"
#include "idl/convert_map.hpp"
#include "idl/dds/outbox.hpp"
#include "idl/limits.hpp"
#include "server/dds_endpoints.hpp"

namespace cairn {
namespace {

// Transactions put in order at a time, and their approximate memory.
constexpr std::size_t kBatch = 1024, kBatchBytes = 32u << 20;

// Approximately.
std::size_t memory_of(const Transaction& transaction) {
  std::size_t bytes = sizeof transaction + transaction.edits.size() * sizeof(FactorEdit);
  for (const NewVariable& variable : transaction.variables)
    bytes += sizeof variable + 8 * (variable.start.size() + variable.odometry.size());
  for (const NewFactor& factor : transaction.factors)
    bytes += sizeof factor + factor.nodes.size() * sizeof(NodeId) + 8 * factor.numbers.size() +
             factor.payloads.size() * sizeof(ContentHash);
  return bytes;
}

class DdsTransport final : public Transport {
 public:
  explicit DdsTransport(const DdsTransportOptions& options) : options_(options) {}
  ~DdsTransport() override { stop(); }

  Result<void> start(TransportListener& listener) override;
  void stop() noexcept override;

  void publish_receipts(const std::vector<Receipt>& receipts) override {
    for (const Receipt& receipt : receipts) hold(&DaemonEndpoints::receipt, receipt);
    flush(&DaemonEndpoints::receipt);
  }
  void publish(const SourceState& state) override { write(&DaemonEndpoints::source_state, state); }
  void forget(const std::string& source, std::uint64_t epoch) override;
  void publish(const PayloadReceipt& receipt) override {
    write(&DaemonEndpoints::payload_receipt, receipt);
  }
  void publish_poses(const EstimateRevisions& revisions,
                     const std::vector<PoseChunk>& chunks) override {
    const std::lock_guard lock(pose_rounds_);
    for (const PoseChunk& chunk : chunks) hold(&DaemonEndpoints::poses, chunk, revisions);
    hold_sample(&DaemonEndpoints::poses, wire::end_of_pose_round(revisions));
    flush(&DaemonEndpoints::poses);
  }
  void publish_landmarks(const EstimateRevisions& revisions,
                         const std::vector<LandmarkChunk>& chunks) override {
    const std::lock_guard lock(landmark_rounds_);
    for (const LandmarkChunk& chunk : chunks) hold(&DaemonEndpoints::landmarks, chunk, revisions);
    hold_sample(&DaemonEndpoints::landmarks, wire::end_of_landmark_round(revisions));
    flush(&DaemonEndpoints::landmarks);
  }
  void publish(const Correction& correction) override {
    write(&DaemonEndpoints::correction, correction);
  }
  void publish_tile_index(const std::vector<TileBlock>& blocks) override {
    for (const TileBlock& block : blocks) hold(&DaemonEndpoints::tile_index, block);
    flush(&DaemonEndpoints::tile_index);
  }
  void publish(const TileAnswer& answer) override;
  void publish(const Status& status) override;
  void publish(const Event& event) override;
  void reply(const Reply& reply) override;

 private:
  template <class Wire, class Message>
  void write(dds::Writer<Wire> DaemonEndpoints::*writer, const Message& message) {
    hold(writer, message);
    flush(writer);
  }
  // Until flush(). `more` stands between message and arena in to_wire().
  template <class Wire, class Message, class... More>
  void hold(dds::Writer<Wire> DaemonEndpoints::*writer, const Message& message,
            const More&... more) {
    wire::Arena arena;
    hold_sample(writer, wire::to_wire(message, more..., arena));
  }
  template <class Wire>
  void hold_sample(dds::Writer<Wire> DaemonEndpoints::*writer, const Wire& sample) {
    const std::shared_lock lock(endpoints_mutex_);
    if (!running_) return;
    if (const auto code = ((*endpoints_).*writer).write_held(sample); code < 0)
      trouble_(dds::to_error(code, std::string("cannot write ") + dds::Topic<Wire>::kName));
  }
  template <class Wire>
  void flush(dds::Writer<Wire> DaemonEndpoints::*writer) {
    const std::shared_lock lock(endpoints_mutex_);
    if (running_) ((*endpoints_).*writer).flush();
  }

  Result<void> attach_all(TransportListener& listener);
  int take_transactions(TransportListener& listener);
  static void report_unreadable(const cairn_wire_Transaction& sample, std::string reason,
                                const Sender& sender, TransportListener& listener);
  int take_clients(TransportListener& listener);
  int take_payloads(TransportListener& listener);
  static void report_unreadable(const cairn_wire_Payload& sample, std::string reason,
                                const Sender& sender, TransportListener& listener);
  int take_commands(TransportListener& listener);
  int take_tile_requests(TransportListener& listener);
  void forget_tiles_of(std::uint64_t client);
  int take_rivals(TransportListener& listener);

  DdsTransportOptions options_;
  dds::TroubleHandler trouble_;  // outlives what reports to it
  std::optional<dds::Participant> participant_;
  std::shared_mutex endpoints_mutex_;  // who writes shares it
  std::optional<DaemonEndpoints> endpoints_;
  std::unique_ptr<dds::WaitLoop> loop_;
  dds::Outbox outbox_;
  std::thread thread_;
  std::atomic<bool> running_ = false;
  std::mutex pose_rounds_, landmark_rounds_;
  std::mutex answered_mutex_;
  std::deque<std::uint64_t> answered_;  // clients for which the middleware keeps an answer
  std::mutex own_status_mutex_;
  std::optional<std::pair<std::int64_t, std::uint64_t>> own_status_;  // started_ns, store
};

Result<void> DdsTransport::start(TransportListener& listener) {
  if (participant_) return Error{ErrorCode::kUsage, "the transport was started before"};
  trouble_ = [&listener](Error error) { listener.on_trouble(std::move(error)); };
  auto participant =
      dds::Participant::open(options_.domain, options_.network, dds::Sending::kOnFlush);
  if (!participant) return participant.error();
  participant_.emplace(std::move(*participant));
  auto endpoints = DaemonEndpoints::make(*participant_, &trouble_);
  if (!endpoints) return endpoints.error();
  endpoints_.emplace(std::move(*endpoints));
  auto loop = dds::WaitLoop::make(*participant_);
  if (!loop) return loop.error();
  loop_ = std::move(*loop);
  if (auto attached = attach_all(listener); !attached) return attached;
  running_ = true;
  outbox_.start(trouble_);
  thread_ = std::thread([this] { loop_->run(trouble_); });
  return {};
}

Result<void> DdsTransport::attach_all(TransportListener& listener) {
  const auto attach = [&](auto& reader, int (DdsTransport::*take)(TransportListener&)) {
    return loop_->attach(reader.handle(),
                         [this, take, &listener] { return (this->*take)(listener); });
  };
  // Clients first: a source is known before its transactions arrive.
  auto attached = attach(endpoints_->client_state, &DdsTransport::take_clients);
  if (attached) attached = attach(endpoints_->transaction, &DdsTransport::take_transactions);
  if (attached) attached = attach(endpoints_->payload, &DdsTransport::take_payloads);
  if (attached) attached = attach(endpoints_->command, &DdsTransport::take_commands);
  if (attached) attached = attach(endpoints_->tile_request, &DdsTransport::take_tile_requests);
  if (attached) attached = attach(endpoints_->rival, &DdsTransport::take_rivals);
  return attached;
}

// The endpoints end here: their listeners would go on to report to who may be gone.
void DdsTransport::stop() noexcept {
  if (thread_.joinable()) {
    outbox_.stop();  // what is queued still goes out, if it can
    running_ = false;
    loop_->stop();
    thread_.join();
  }
  const std::unique_lock lock(endpoints_mutex_);
  loop_.reset();
  endpoints_.reset();
}

// Samples come out instance by instance; put back in the order in which each source sent them.
int DdsTransport::take_transactions(TransportListener& listener) {
  std::vector<std::pair<Transaction, Sender>> batch;
  std::size_t bytes = 0;
  int count = 0;
  do {
    count = endpoints_->transaction.take(
        [&](const cairn_wire_Transaction& sample, const dds_sample_info_t& info) {
          if (!info.valid_data) return;
          const Sender sender{.writer = sample.writer, .arrived_ns = wall_clock_ns()};
          auto transaction = wire::from_wire(sample);
          if (transaction) {
            bytes += memory_of(*transaction);
            batch.emplace_back(std::move(*transaction), sender);
            return;
          }
          report_unreadable(sample, transaction.error().message, sender, listener);
        });
  } while (count == static_cast<int>(dds::kTake) && batch.size() < kBatch && bytes < kBatchBytes);
  std::stable_sort(batch.begin(), batch.end(),
                   [](const auto& a, const auto& b) { return a.first.key < b.first.key; });
  for (auto& [transaction, sender] : batch) listener.on_transaction(std::move(transaction), sender);
  return count;
}

void DdsTransport::report_unreadable(const cairn_wire_Transaction& sample, std::string reason,
                                     const Sender& sender, TransportListener& listener) {
  TransactionKey key = wire::key_of(sample);
  if (!limits::check_name("source", key.source))  // nobody could receive an answer
    return listener.on_trouble({ErrorCode::kBadInput, std::move(reason), "a transaction"});
  const auto code = sample.version == wire::kVersion ? RefusalCode::kMalformed  //
                                                     : RefusalCode::kVersion;
  listener.on_unreadable_transaction(
      {std::move(key), wire::content_of(sample), code, std::move(reason)}, sender);
}

int DdsTransport::take_clients(TransportListener& listener) {
  return endpoints_->client_state.take(
      [&](const cairn_wire_Client_state& sample, const dds_sample_info_t& info) {
        const Sender sender{.writer = sample.writer, .arrived_ns = wall_clock_ns()};
        if (info.valid_data) {
          auto client = wire::from_wire(sample);
          if (client)
            listener.on_client(std::move(*client), sender);
          else
            listener.on_trouble(client.error());
        }
        if (info.instance_state != DDS_ALIVE_INSTANCE_STATE && sample.source != nullptr)
          listener.on_source_lost(sample.source, sender);
      });
}

void DdsTransport::report_unreadable(const cairn_wire_Payload& sample, std::string reason,
                                     const Sender& sender, TransportListener& listener) {
  Payload payload{.source = sample.source, .epoch = sample.epoch, .number = sample.number};
  std::copy_n(sample.content, payload.hash.size(), payload.hash.begin());
  listener.on_unreadable_payload(std::move(payload), std::move(reason), sender);
}

int DdsTransport::take_payloads(TransportListener& listener) {
  return endpoints_->payload.take(
      [&](const cairn_wire_Payload& sample, const dds_sample_info_t& info) {
        if (!info.valid_data) return;
        const Sender sender{.writer = sample.writer, .arrived_ns = wall_clock_ns()};
        auto payload = wire::from_wire(sample);
        if (payload)
          listener.on_payload(std::move(*payload), sender);
        else if (sample.source == nullptr || !limits::check_name("source", sample.source))
          listener.on_trouble(payload.error());
        else
          report_unreadable(sample, payload.error().message, sender, listener);
      });
}

int DdsTransport::take_commands(TransportListener& listener) {
  return endpoints_->command.take(
      [&](const cairn_wire_Command& sample, const dds_sample_info_t& info) {
        if (!info.valid_data) return;
        auto command = wire::from_wire(sample);
        if (command)
          listener.on_command(std::move(*command));
        else
          reply({.key = {sample.client, sample.number},
                 .error = ErrorCode::kBadInput,
                 .text = command.error().message});
      });
}

int DdsTransport::take_tile_requests(TransportListener& listener) {
  return endpoints_->tile_request.take(
      [&](const cairn_wire_Tile_request& sample, const dds_sample_info_t& info) {
        if (info.instance_state != DDS_ALIVE_INSTANCE_STATE) forget_tiles_of(sample.client);
        if (!info.valid_data) return;
        auto request = wire::from_wire(sample);
        if (request) return listener.on_tile_request(std::move(*request));
        publish(TileAnswer{.client = sample.client,
                           .number = sample.number,
                           .run = sample.run,
                           .map = {},
                           .error = ErrorCode::kBadInput,
                           .reason = request.error().message,
                           .tiles = {}});
      });
}

// Clients can invent names of theirs.
void DdsTransport::publish(const TileAnswer& answer) {
  constexpr std::size_t kMostClients = 256;
  std::optional<std::uint64_t> oldest;
  {
    const std::lock_guard lock(answered_mutex_);
    std::erase(answered_, answer.client);
    answered_.push_back(answer.client);
    if (answered_.size() > kMostClients) oldest = answered_.front();
  }
  write(&DaemonEndpoints::tiles, answer);
  if (oldest) forget_tiles_of(*oldest);
}

void DdsTransport::forget_tiles_of(std::uint64_t client) {
  {
    const std::lock_guard lock(answered_mutex_);
    if (std::erase(answered_, client) == 0) return;
  }
  const std::shared_lock lock(endpoints_mutex_);
  if (!running_) return;
  cairn_wire_Occupancy_tile key{};
  key.client = client;
  (void)endpoints_->tiles.forget(key);
}

int DdsTransport::take_rivals(TransportListener& listener) {
  return endpoints_->rival.take(
      [&](const cairn_wire_Status& sample, const dds_sample_info_t& info) {
        if (!info.valid_data) return;
        {
          const std::lock_guard lock(own_status_mutex_);
          if (own_status_ == std::pair(sample.started_ns, sample.store)) return;
        }
        if (auto status = wire::from_wire(sample)) listener.on_rival(std::move(*status));
      });
}

void DdsTransport::publish(const Status& status) {
  {
    const std::lock_guard lock(own_status_mutex_);
    own_status_.emplace(status.started_ns, status.head.store);
  }
  write(&DaemonEndpoints::status, status);
}

void DdsTransport::forget(const std::string& source, std::uint64_t epoch) {
  const std::shared_lock lock(endpoints_mutex_);
  if (!running_) return;
  SourceState state;
  state.source = source;
  state.epoch = epoch;
  wire::Arena arena;
  (void)endpoints_->source_state.forget(wire::to_wire(state, arena));
  Receipt receipt{.key = {source, epoch, 0}, .revision = {}};
  for (; receipt.key.sequence < wire::kSlots; ++receipt.key.sequence)
    (void)endpoints_->receipt.forget(wire::to_wire(receipt, arena));
  PayloadReceipt payload{.source = source, .epoch = epoch};
  for (; payload.number < wire::kPayloadSlots; ++payload.number)
    (void)endpoints_->payload_receipt.forget(wire::to_wire(payload, arena));
}

// Keep-all writers wait for slow readers: from a thread that may.
void DdsTransport::publish(const Event& event) {
  if (!running_) return;
  outbox_.push(sizeof event + event.text.size(), [this, event] {
    wire::Arena arena;
    return endpoints_->event.write(wire::to_wire(event, arena));
  });
}

void DdsTransport::reply(const Reply& reply) {
  if (!running_) return;
  std::string_view rest = reply.text;
  std::uint32_t part = 0;
  do {
    std::string text(limits::cut(rest, limits::kText));
    rest.remove_prefix(text.size());
    cairn_wire_Reply sample{};
    sample.client = reply.key.client;
    sample.version = wire::kVersion;
    sample.number = reply.key.number;
    sample.part = part++;
    sample.last = rest.empty();
    sample.error_code = reply.error ? static_cast<std::uint8_t>(*reply.error) : 0;
    outbox_.push(text.size(), [this, text, sample]() mutable {
      sample.text = text.data();
      return endpoints_->reply.write(sample);
    });
  } while (!rest.empty());
}

}  // namespace

std::unique_ptr<Transport> make_dds_transport(const DdsTransportOptions& options) {
  return std::make_unique<DdsTransport>(options);
}

}  // namespace cairn
