// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>

#include "idl/convert.hpp"
#include "idl/wire_checks.hpp"

namespace cairn::wire {
namespace {

ContentHash read_hash(const cairn_wire_Hash& wire) {
  ContentHash hash;
  std::copy_n(wire, hash.size(), hash.begin());
  return hash;
}

}  // namespace

cairn_wire_Source_state to_wire(const SourceState& state, Arena&) {
  cairn_wire_Source_state wire{};
  wire.source = lend(state.source);
  wire.epoch = state.epoch;
  wire.version = kVersion;
  wire.highest_decided = state.highest_decided;
  wire.revision = to_wire(state.revision);
  std::copy(state.chain.begin(), state.chain.end(), wire.chain);
  wire.daemon_ns = state.daemon_ns;
  return wire;
}

Result<SourceState> from_wire(const cairn_wire_Source_state& wire) {
  Checks checks;
  checks.version(wire.version);
  return checks.result(SourceState{.source = checks.name("source", wire.source),
                                   .epoch = wire.epoch,
                                   .highest_decided = wire.highest_decided,
                                   .revision = from_wire(wire.revision),
                                   .chain = read_hash(wire.chain),
                                   .daemon_ns = wire.daemon_ns});
}

cairn_wire_Client_state to_wire(const ClientState& state, std::uint64_t writer, Arena&) {
  cairn_wire_Client_state wire{};
  wire.source = lend(state.source);
  wire.epoch = state.epoch;
  wire.writer = writer;
  wire.version = kVersion;
  wire.robot = lend(state.robot);
  wire.highest_decided = state.highest_decided;
  wire.receipted = to_wire(state.receipted);
  wire.oldest_kept = state.oldest_kept;
  wire.sent_ns = state.sent_ns;
  wire.daemon_ns = state.daemon_ns;
  return wire;
}

Result<ClientState> from_wire(const cairn_wire_Client_state& wire) {
  Checks checks;
  checks.version(wire.version);
  return checks.result(ClientState{.source = checks.name("source", wire.source),
                                   .epoch = wire.epoch,
                                   .robot = checks.optional_name("robot", wire.robot),
                                   .highest_decided = wire.highest_decided,
                                   .receipted = from_wire(wire.receipted),
                                   .oldest_kept = wire.oldest_kept,
                                   .sent_ns = wire.sent_ns,
                                   .daemon_ns = wire.daemon_ns});
}

cairn_wire_Payload to_wire(const Payload& payload, std::uint64_t writer, Arena&) {
  cairn_wire_Payload wire{};
  wire.source = lend(payload.source);
  wire.epoch = payload.epoch;
  wire.slot = static_cast<std::uint8_t>(payload.number % kPayloadSlots);
  wire.version = kVersion;
  wire.number = payload.number;
  wire.writer = writer;
  std::copy(payload.hash.begin(), payload.hash.end(), wire.content);
  wire.type = lend(payload.type);
  wire.bytes._maximum = wire.bytes._length = static_cast<std::uint32_t>(payload.bytes.size());
  wire.bytes._buffer =
      const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(payload.bytes.data()));
  return wire;
}

Result<Payload> from_wire(const cairn_wire_Payload& wire) {
  Checks checks;
  checks.version(wire.version);
  Payload payload{.source = checks.name("source", wire.source),
                  .epoch = wire.epoch,
                  .number = wire.number,
                  .hash = read_hash(wire.content),
                  .type = checks.text("type", wire.type, limits::kWord),
                  .bytes = {}};
  if (wire.slot != wire.number % kPayloadSlots) checks.fail("slot is not number mod 16");
  if (checks.count("bytes", wire.bytes._length, kMaxPayloadBytes))
    payload.bytes.assign(reinterpret_cast<const char*>(wire.bytes._buffer), wire.bytes._length);
  return checks.result(std::move(payload));
}

cairn_wire_Payload_receipt to_wire(const PayloadReceipt& receipt, Arena& arena) {
  cairn_wire_Payload_receipt wire{};
  wire.source = lend(receipt.source);
  wire.epoch = receipt.epoch;
  wire.slot = static_cast<std::uint8_t>(receipt.number % kPayloadSlots);
  wire.version = kVersion;
  wire.number = receipt.number;
  std::copy(receipt.hash.begin(), receipt.hash.end(), wire.content);
  wire.answer = static_cast<std::uint8_t>(receipt.answer);
  wire.reason = lend_cut(receipt.reason, limits::kReason, arena);
  return wire;
}

Result<PayloadReceipt> from_wire(const cairn_wire_Payload_receipt& wire) {
  Checks checks;
  checks.version(wire.version);
  return checks.result(
      PayloadReceipt{.source = checks.name("source", wire.source),
                     .epoch = wire.epoch,
                     .number = wire.number,
                     .hash = read_hash(wire.content),
                     .answer = checks.word("answer", wire.answer, PayloadAnswer::kBusy),
                     .reason = checks.text("reason", wire.reason, limits::kReason)});
}

}  // namespace cairn::wire
