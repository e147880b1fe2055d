// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/transaction.hpp"

#include <cstdio>

#include "cairn/graph/node_bytes.hpp"

namespace cairn {
namespace {

constexpr std::uint16_t kTransactionVersion = 1;

void write_variable(ByteWriter& to, FrameTable& frames, const NewVariable& variable) {
  frames.write_node(to, variable.node);
  to.integer(static_cast<std::uint8_t>(variable.type));
  to.integer(variable.stamp_ns);
  write_numbers(to, variable.start);
  write_numbers(to, variable.odometry);
}

NewVariable read_variable(ByteReader& from, FrameTable& frames) {
  NewVariable variable;
  variable.node = frames.read_node(from);
  variable.type = from.enumerator(VariableType::kPose2, VariableType::kPoint3);
  variable.stamp_ns = from.integer<std::int64_t>();
  variable.start = read_numbers(from);
  variable.odometry = read_numbers(from);
  return variable;
}

void write_factor(ByteWriter& to, FrameTable& frames, const NewFactor& factor) {
  to.integer(static_cast<std::uint16_t>(factor.type));
  to.integer(static_cast<std::uint8_t>(factor.kind));
  to.count(factor.nodes.size());
  for (const NodeId& node : factor.nodes) frames.write_node(to, node);
  write_numbers(to, factor.numbers);
  to.count(factor.payloads.size());
  for (const ContentHash& payload : factor.payloads) to.hash(payload);
}

NewFactor read_factor(ByteReader& from, FrameTable& frames) {
  NewFactor factor;
  factor.type = static_cast<FactorType>(from.integer<std::uint16_t>());
  factor.kind = from.enumerator(FactorKind::kOdometry, FactorKind::kOther);
  const std::size_t nodes = from.count(12);
  factor.nodes.reserve(nodes);
  for (std::size_t i = 0; i < nodes && from.ok(); ++i)
    factor.nodes.push_back(frames.read_node(from));
  factor.numbers = read_numbers(from);
  factor.payloads.resize(from.count(sizeof(ContentHash)));
  for (ContentHash& payload : factor.payloads) payload = from.hash();
  return factor;
}

void write_edit(ByteWriter& to, const FactorEdit& edit) {
  write_factor_name(to, edit.factor);
  to.integer(static_cast<std::uint8_t>(edit.change));
}

FactorEdit read_edit(ByteReader& from) {
  FactorEdit edit;
  edit.factor = read_factor_name(from);
  edit.change = from.enumerator(FactorChange::kDisable, FactorChange::kRemove);
  return edit;
}

FrameTable frames_of(const Transaction& transaction) {
  FrameTable frames;
  for (const NewVariable& variable : transaction.variables) frames.add(variable.node.frame);
  for (const NewFactor& factor : transaction.factors) {
    for (const NodeId& node : factor.nodes) frames.add(node.frame);
  }
  return frames;
}

Error broken_transaction(const ByteReader& from) {
  return {ErrorCode::kBadInput, "the transaction " + std::string(from.problem()),
          "byte " + std::to_string(from.place())};
}

}  // namespace

std::string encode(const Transaction& transaction) {
  std::string bytes;
  ByteWriter to(bytes);
  to.integer(kTransactionVersion);
  write_key(to, transaction.key);
  to.integer(transaction.sent_ns);
  FrameTable frames = frames_of(transaction);
  frames.write(to);
  to.count(transaction.variables.size());
  for (const NewVariable& variable : transaction.variables) write_variable(to, frames, variable);
  to.count(transaction.factors.size());
  for (const NewFactor& factor : transaction.factors) write_factor(to, frames, factor);
  to.count(transaction.edits.size());
  for (const FactorEdit& edit : transaction.edits) write_edit(to, edit);
  return bytes;
}

Result<Transaction> decode_transaction(std::string_view bytes) {
  ByteReader from(bytes);
  const auto version = from.integer<std::uint16_t>();
  if (from.ok() && version != kTransactionVersion)
    return Error{ErrorCode::kBadInput,
                 "the transaction has format version " + std::to_string(version) +
                     ", this Cairn knows version 1 only: update it",
                 "byte 0"};
  Transaction transaction;
  transaction.key = read_key(from);
  transaction.sent_ns = from.integer<std::int64_t>();
  FrameTable frames = FrameTable::read(from);
  const std::size_t variables = from.count(29);
  transaction.variables.reserve(variables);
  for (std::size_t i = 0; i < variables && from.ok(); ++i)
    transaction.variables.push_back(read_variable(from, frames));
  const std::size_t factors = from.count(15);
  transaction.factors.reserve(factors);
  for (std::size_t i = 0; i < factors && from.ok(); ++i)
    transaction.factors.push_back(read_factor(from, frames));
  const std::size_t edits = from.count(26);
  transaction.edits.reserve(edits);
  for (std::size_t i = 0; i < edits && from.ok(); ++i) transaction.edits.push_back(read_edit(from));
  frames.require_all_used(from);
  if (from.ok() && from.left() > 0) from.fail("is followed by bytes that belong to nothing");
  if (!from.ok()) return broken_transaction(from);
  return transaction;
}

std::string_view to_string(RefusalCode code) {
  switch (code) {
    case RefusalCode::kMalformed:
      return "malformed";
    case RefusalCode::kNotFinite:
      return "not finite";
    case RefusalCode::kInformation:
      return "information not positive semidefinite";
    case RefusalCode::kUnknownVariable:
      return "unknown variable";
    case RefusalCode::kConflict:
      return "conflict";
    case RefusalCode::kStale:
      return "stale";
    case RefusalCode::kForeignSource:
      return "source name taken";
    case RefusalCode::kVersion:
      return "newer format";
    case RefusalCode::kDatum:
      return "other datum";
    case RefusalCode::kStorageFull:
      return "storage full";
    case RefusalCode::kBusy:
      return "busy";
    case RefusalCode::kOverBudget:
      return "over budget";
  }
  return "refused";
}

std::string to_string(const Revision& revision) {
  char store[17];
  std::snprintf(store, sizeof store, "%016llx", static_cast<unsigned long long>(revision.store));
  return std::string(store) + ':' + std::to_string(revision.era) + ':' +
         std::to_string(revision.number);
}

}  // namespace cairn
