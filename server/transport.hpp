// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cairn/graph/transaction.hpp"
#include "idl/map_messages.hpp"
#include "idl/messages.hpp"

namespace cairn {

/// Who sent a message: one live writer. A program that restarts is a new one.
struct Sender {
  std::uint64_t writer = 0;     ///< never reused while the daemon runs
  std::int64_t arrived_ns = 0;  ///< the daemon's clock
};

/// A transaction that breaks the wire's rules.
struct UnreadableTransaction {
  TransactionKey key;     ///< its names are whole
  ContentHash content{};  ///< of everything in it: repetitions have the same
  RefusalCode code = RefusalCode::kMalformed;
  std::string reason;
};

/// What a transport tells the daemon. All calls come from one thread, in arrival order per sender,
/// between start() and the return of stop(). They must not block for long: input waits meanwhile.
class TransportListener {
 public:
  virtual ~TransportListener() = default;

  /// Well formed by the wire's rules; nothing is known about its sense. May be a repetition.
  virtual void on_transaction(Transaction transaction, const Sender& sender) = 0;
  virtual void on_unreadable_transaction(UnreadableTransaction transaction,
                                         const Sender& sender) = 0;
  /// A client came, or went on: at its start, when it is connected again, and now and then.
  virtual void on_client(ClientState client, const Sender& sender) = 0;
  /// The writer of this source ended, or was not heard of for the lease. It may come back (frozen
  /// process), as the same sender.
  virtual void on_source_lost(std::string source, const Sender& sender) = 0;
  virtual void on_payload(Payload payload, const Sender& sender) = 0;
  /// One that breaks the wire's rules, without its bytes; its names are whole.
  virtual void on_unreadable_payload(Payload payload, std::string reason, const Sender& sender) = 0;
  virtual void on_command(Command command) = 0;
  /// Whoever serves no maps leaves it unanswered.
  virtual void on_tile_request(TileRequest /*request*/) {}
  /// Another daemon lives in the domain.
  virtual void on_rival(Status rival) = 0;
  /// The middleware failed or a peer does not fit (other type, other QoS): for the log.
  virtual void on_trouble(Error error) = 0;
};

/// The daemon's side of the wire, without the middleware. publish() and reply() may be called from
/// any thread, never wait for a peer, and after stop() do nothing.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Connects and begins to call `listener`, which lives until stop(). kUnreachable where the
  /// network cannot be used; kUsage after a first start().
  virtual Result<void> start(TransportListener& listener) = 0;
  virtual void stop() noexcept = 0;

  /// What was decided together goes out together.
  virtual void publish_receipts(const std::vector<Receipt>& receipts) = 0;
  virtual void publish(const SourceState& state) = 0;
  /// What was said to this spool is no longer kept for it.
  virtual void forget(const std::string& source, std::uint64_t epoch) = 0;
  virtual void publish(const PayloadReceipt& receipt) = 0;
  /// One round: the chunks that changed since the last one. Clients see whole rounds only, and
  /// learn `revisions` even where no chunk changed. revisions.graph never falls within an era.
  virtual void publish_poses(const EstimateRevisions& revisions,
                             const std::vector<PoseChunk>& chunks) = 0;
  virtual void publish_landmarks(const EstimateRevisions& revisions,
                                 const std::vector<LandmarkChunk>& chunks) = 0;
  virtual void publish(const Correction& correction) = 0;
  /// Latest kept of each block.
  virtual void publish_tile_index(const std::vector<TileBlock>& blocks) = 0;
  /// To the client that has asked.
  virtual void publish(const TileAnswer& answer) = 0;
  virtual void publish(const Status& status) = 0;
  virtual void publish(const Event& event) = 0;
  virtual void reply(const Reply& reply) = 0;
};

}  // namespace cairn
