// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "idl/convert.hpp"
#include "idl/wire_checks.hpp"

namespace cairn::wire {
namespace {

cairn_wire_Node to_wire(const NodeId& node) {
  return {.robot = lend(node.frame.robot), .epoch = node.frame.epoch, .index = node.index};
}

cairn_wire_New_variable to_wire(const NewVariable& variable) {
  cairn_wire_New_variable wire{};
  wire.node = to_wire(variable.node);
  wire.type = static_cast<std::uint8_t>(variable.type);
  wire.stamp_ns = variable.stamp_ns;
  lend(wire.start, variable.start);
  lend(wire.odometry, variable.odometry);
  return wire;
}

cairn_wire_New_factor to_wire(const NewFactor& factor, Arena& arena) {
  cairn_wire_New_factor wire{};
  wire.type = static_cast<std::uint16_t>(factor.type);
  wire.factor_kind = static_cast<std::uint8_t>(factor.kind);
  auto* nodes = make_sequence(wire.nodes, factor.nodes.size(), arena);
  for (const NodeId& node : factor.nodes) *nodes++ = to_wire(node);
  lend(wire.numbers, factor.numbers);
  auto* payloads = make_sequence(wire.payloads, factor.payloads.size(), arena);
  for (const ContentHash& hash : factor.payloads)
    std::memcpy(*payloads++, hash.data(), hash.size());
  return wire;
}

cairn_wire_Factor_edit to_wire(const FactorEdit& edit) {
  const TransactionKey& key = edit.factor.transaction;
  return {.factor = {.source = lend(key.source),
                     .epoch = key.epoch,
                     .sequence_number = key.sequence,
                     .index = edit.factor.index},
          .change = static_cast<std::uint8_t>(edit.change)};
}

NodeId read_node(Checks& checks, const cairn_wire_Node& wire) {
  return {.frame = {.robot = checks.name("robot", wire.robot), .epoch = wire.epoch},
          .index = wire.index};
}

NewVariable read_variable(Checks& checks, const cairn_wire_New_variable& wire) {
  NewVariable variable;
  variable.node = read_node(checks, wire.node);
  variable.type = checks.word("type", wire.type, VariableType::kPoint3);
  variable.stamp_ns = wire.stamp_ns;
  variable.start = checks.numbers("start", wire.start, limits::kNumbersOfVariable);
  variable.odometry = checks.numbers("odometry", wire.odometry, limits::kNumbersOfVariable);
  return variable;
}

NewFactor read_factor(Checks& checks, const cairn_wire_New_factor& wire) {
  NewFactor factor;
  factor.type = static_cast<FactorType>(wire.type);
  factor.kind = checks.word("kind", wire.factor_kind, FactorKind::kOther);
  factor.numbers = checks.numbers("numbers", wire.numbers, limits::kNumbersOfFactor);
  if (checks.count("nodes", wire.nodes._length, limits::kNodesOfFactor))
    for (std::uint32_t i = 0; i < wire.nodes._length; ++i)
      factor.nodes.push_back(read_node(checks, wire.nodes._buffer[i]));
  if (checks.count("payloads", wire.payloads._length, limits::kPayloadsOfFactor)) {
    factor.payloads.resize(wire.payloads._length);
    for (std::uint32_t i = 0; i < wire.payloads._length; ++i)
      std::copy_n(wire.payloads._buffer[i], 32, factor.payloads[i].begin());
  }
  return factor;
}

FactorEdit read_edit(Checks& checks, const cairn_wire_Factor_edit& wire) {
  FactorEdit edit;
  edit.factor.transaction = {.source = checks.name("source", wire.factor.source),
                             .epoch = wire.factor.epoch,
                             .sequence = wire.factor.sequence_number};
  edit.factor.index = wire.factor.index;
  edit.change = checks.word("change", wire.change, FactorChange::kRemove);
  return edit;
}

template <class T, class Sequence, class Read>
std::vector<T> read_all(Checks& checks, const char* what, const Sequence& wire, std::size_t most,
                        Read read) {
  std::vector<T> all;
  if (!checks.count(what, wire._length, most)) return all;
  all.reserve(wire._length);
  for (std::uint32_t i = 0; i < wire._length && checks.ok(); ++i) {
    checks.enter(what, i);
    all.push_back(read(checks, wire._buffer[i]));
  }
  checks.leave();
  return all;
}

// Everything in a transaction, one after the other, each with its length.
class Content {
 public:
  template <class Number>
    requires std::is_arithmetic_v<Number>
  void add(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const char* text) {
    const std::string_view view = text == nullptr ? std::string_view() : text;
    add(view.size());
    bytes_.append(view);
  }
  void add(const cairn_wire_Hash& hash) {
    bytes_.append(reinterpret_cast<const char*>(hash), sizeof(cairn_wire_Hash));
  }
  void add(const cairn_wire_Node& node) { add_all(node.robot, node.epoch, node.index); }
  void add(const cairn_wire_New_variable& variable) {
    add_all(variable.node, variable.type, variable.stamp_ns);
    add_each(variable.start);
    add_each(variable.odometry);
  }
  void add(const cairn_wire_New_factor& factor) {
    add_all(factor.type, factor.factor_kind);
    add_each(factor.nodes);
    add_each(factor.numbers);
    add_each(factor.payloads);
  }
  void add(const cairn_wire_Factor_edit& edit) {
    add_all(static_cast<const char*>(edit.factor.source), edit.factor.epoch,
            edit.factor.sequence_number, edit.factor.index, edit.change);
  }
  template <class... T>
  void add_all(const T&... values) {
    (add(values), ...);
  }
  template <class Sequence>
  void add_each(const Sequence& sequence) {
    add(sequence._length);
    for (std::uint32_t i = 0; i < sequence._length; ++i) add(sequence._buffer[i]);
  }
  [[nodiscard]] ContentHash hash() const { return content_hash(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace

ContentHash content_of(const cairn_wire_Transaction& wire) {
  Content content;
  content.add_all(wire.version, wire.slot, wire.sequence_number, wire.sent_ns);
  content.add_each(wire.variables);
  content.add_each(wire.factors);
  content.add_each(wire.edits);
  return content.hash();
}

cairn_wire_Transaction to_wire(const Transaction& transaction, std::uint64_t writer, Arena& arena) {
  cairn_wire_Transaction wire{};
  wire.source = lend(transaction.key.source);
  wire.epoch = transaction.key.epoch;
  wire.slot = static_cast<std::uint8_t>(transaction.key.sequence % kSlots);
  wire.version = kVersion;
  wire.sequence_number = transaction.key.sequence;
  wire.writer = writer;
  wire.sent_ns = transaction.sent_ns;
  auto* variables = make_sequence(wire.variables, transaction.variables.size(), arena);
  for (const NewVariable& variable : transaction.variables) *variables++ = to_wire(variable);
  auto* factors = make_sequence(wire.factors, transaction.factors.size(), arena);
  for (const NewFactor& factor : transaction.factors) *factors++ = to_wire(factor, arena);
  auto* edits = make_sequence(wire.edits, transaction.edits.size(), arena);
  for (const FactorEdit& edit : transaction.edits) *edits++ = to_wire(edit);
  return wire;
}

TransactionKey key_of(const cairn_wire_Transaction& wire) {
  Checks checks;
  return {.source = checks.name("source", wire.source),
          .epoch = wire.epoch,
          .sequence = wire.sequence_number};
}

Result<Transaction> from_wire(const cairn_wire_Transaction& wire) {
  Checks checks;
  checks.version(wire.version);
  if (!checks.ok()) return checks.result(Transaction{});
  Transaction transaction;
  transaction.key = {.source = checks.name("source", wire.source),
                     .epoch = wire.epoch,
                     .sequence = wire.sequence_number};
  if (wire.sequence_number == 0) checks.fail("sequence is 0; expected 1 or more");
  if (wire.slot != wire.sequence_number % kSlots)
    checks.fail("slot is " + std::to_string(wire.slot) +
                "; expected sequence mod 256 = " + std::to_string(wire.sequence_number % kSlots));
  transaction.sent_ns = wire.sent_ns;
  transaction.variables =
      read_all<NewVariable>(checks, "variables", wire.variables, limits::kVariables, read_variable);
  transaction.factors =
      read_all<NewFactor>(checks, "factors", wire.factors, limits::kFactors, read_factor);
  transaction.edits = read_all<FactorEdit>(checks, "edits", wire.edits, limits::kEdits, read_edit);
  return checks.result(std::move(transaction));
}

cairn_wire_Receipt to_wire(const Receipt& receipt, Arena& arena) {
  cairn_wire_Receipt wire{};
  wire.source = lend(receipt.key.source);
  wire.epoch = receipt.key.epoch;
  wire.slot = static_cast<std::uint8_t>(receipt.key.sequence % kSlots);
  wire.version = kVersion;
  wire.sequence_number = receipt.key.sequence;
  wire.revision = to_wire(receipt.revision);
  wire.refusal = receipt.refusal ? static_cast<std::uint8_t>(*receipt.refusal) : 0;
  wire.reason = lend_cut(receipt.reason, limits::kReason, arena);
  return wire;
}

Result<Receipt> from_wire(const cairn_wire_Receipt& wire) {
  Checks checks;
  checks.version(wire.version);
  Receipt receipt;
  receipt.key = {.source = checks.name("source", wire.source),
                 .epoch = wire.epoch,
                 .sequence = wire.sequence_number};
  receipt.revision = from_wire(wire.revision);
  // A code that this program does not know is kept: whether to try again can be told from it.
  if (wire.refusal != 0) receipt.refusal = static_cast<RefusalCode>(wire.refusal);
  receipt.reason = checks.text("reason", wire.reason, limits::kReason);
  return checks.result(std::move(receipt));
}

}  // namespace cairn::wire
