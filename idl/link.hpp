// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cairn/graph/transaction.hpp"
#include "idl/map_messages.hpp"
#include "idl/messages.hpp"

namespace cairn {

/// What a link tells a client. All calls come from one thread, between start() and the return of
/// stop(). Messages to other clients do not arrive here.
class LinkListener {
 public:
  virtual ~LinkListener() = default;

  virtual void on_receipt(Receipt receipt) = 0;
  virtual void on_source_state(SourceState state) = 0;
  virtual void on_payload_receipt(PayloadReceipt receipt) = 0;
  /// Whole rounds: what changed up to `revisions`, and nothing newer.
  virtual void on_poses(EstimateRevisions revisions, std::vector<PoseChunk> chunks) = 0;
  virtual void on_landmarks(EstimateRevisions revisions, std::vector<LandmarkChunk> chunks) = 0;
  virtual void on_correction(Correction correction) = 0;
  virtual void on_status(Status status) = 0;
  virtual void on_event(Event event) = 0;
  virtual void on_reply(Reply reply) = 0;
  /// Of links that follow maps.
  virtual void on_tile_index(TileBlock /*block*/) {}
  virtual void on_tiles(TileAnswer /*answer*/) {}
  /// The middleware failed, a peer does not fit, or a message could not be read.
  virtual void on_trouble(Error error) = 0;
};

/// A client's side of the wire, without the middleware; the counterpart of server/transport.hpp.
/// Send from any thread; nothing waits for the daemon. An error means that the message was not
/// sent.
class Link {
 public:
  /// Who speaks. `writer` is random and new for every run of a client.
  struct Identity {
    std::string source;  ///< empty: only watches and commands
    std::uint64_t epoch = 0;
    std::uint64_t writer = 0;
    bool follows_maps = false;  ///< hears the index of tiles, may ask for them
  };

  virtual ~Link() = default;

  virtual Result<void> start(LinkListener& listener) = 0;
  virtual void stop() noexcept = 0;

  virtual Result<void> send(const Transaction& transaction) = 0;
  virtual Result<void> send(const ClientState& state) = 0;
  virtual Result<void> send(const Payload& payload) = 0;
  /// kUsage of links that follow no maps.
  virtual Result<void> send(const TileRequest& request) = 0;
  /// Also waits, for at most `timeout_ms`, until a daemon is there to hear it.
  virtual Result<void> send(const Command& command, int timeout_ms) = 0;
};

}  // namespace cairn
