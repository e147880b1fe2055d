// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cairn/command.h>
#include <cairn/estimate.h>
#include <cairn/payload.h>
#include <cairn/source.h>
#include <cairn/status.h>
#include <cairn/transaction.h>

#include <cstddef>
#include <memory_resource>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"
#include "idl/messages.hpp"

/// Between our types and the generated C structs of idl/cairn.
///
/// to_wire() makes a struct that borrows strings and arrays from its argument and from the arena:
/// valid while both live and are not changed. from_wire() copies, trusts nothing, and answers
/// kBadInput with what was found and what was expected.
namespace cairn::wire {

constexpr unsigned kVersion = 1;  ///< of every type; raised when the meaning of a field changes
constexpr unsigned kSlots = 256;  ///< unreceipted transactions in flight per source
constexpr unsigned kPayloadSlots = 16;

/// Memory for the arrays of one message.
class Arena {
 public:
  template <class T>
  T* array(std::size_t count) {
    return count == 0 ? nullptr : static_cast<T*>(memory_.allocate(count * sizeof(T), alignof(T)));
  }

 private:
  std::byte first_[2048];  // most messages need no more
  std::pmr::monotonic_buffer_resource memory_{first_, sizeof first_};
};

/// `writer` names this run of the client, see Sender.
cairn_wire_Transaction to_wire(const Transaction& transaction, std::uint64_t writer, Arena& arena);
cairn_wire_Receipt to_wire(const Receipt& receipt, Arena& arena);
cairn_wire_Source_state to_wire(const SourceState& state, Arena& arena);
cairn_wire_Client_state to_wire(const ClientState& state, std::uint64_t writer, Arena& arena);
cairn_wire_Payload to_wire(const Payload& payload, std::uint64_t writer, Arena& arena);
cairn_wire_Payload_receipt to_wire(const PayloadReceipt& receipt, Arena& arena);
cairn_wire_Poses to_wire(const PoseChunk& chunk, const EstimateRevisions& revisions, Arena& arena);
cairn_wire_Landmarks to_wire(const LandmarkChunk& chunk, const EstimateRevisions& revisions,
                             Arena& arena);
cairn_wire_Correction to_wire(const Correction& correction, Arena& arena);
cairn_wire_Command to_wire(const Command& command, Arena& arena);
cairn_wire_Status to_wire(const Status& status, Arena& arena);
cairn_wire_Event to_wire(const Event& event, Arena& arena);

/// Samples without poses or landmarks that end a round.
cairn_wire_Poses end_of_pose_round(const EstimateRevisions& revisions);
cairn_wire_Landmarks end_of_landmark_round(const EstimateRevisions& revisions);

/// What can be read of a message's key, whatever else is wrong with it.
TransactionKey key_of(const cairn_wire_Transaction& wire);
/// The same for repetitions, whatever is wrong with them; another one than encode() gives.
ContentHash content_of(const cairn_wire_Transaction& wire);
EstimateRevisions from_wire(const cairn_wire_EstimateRevisions& wire);

Result<Transaction> from_wire(const cairn_wire_Transaction& wire);
Result<Receipt> from_wire(const cairn_wire_Receipt& wire);
Result<SourceState> from_wire(const cairn_wire_Source_state& wire);
Result<ClientState> from_wire(const cairn_wire_Client_state& wire);
Result<Payload> from_wire(const cairn_wire_Payload& wire);
Result<PayloadReceipt> from_wire(const cairn_wire_Payload_receipt& wire);
Result<PoseChunk> from_wire(const cairn_wire_Poses& wire);
Result<LandmarkChunk> from_wire(const cairn_wire_Landmarks& wire);
Result<Correction> from_wire(const cairn_wire_Correction& wire);
Result<Command> from_wire(const cairn_wire_Command& wire);
Result<Status> from_wire(const cairn_wire_Status& wire);
Result<Event> from_wire(const cairn_wire_Event& wire);

}  // namespace cairn::wire
