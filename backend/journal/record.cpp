// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/record.hpp"

#include "cairn/graph/node_bytes.hpp"

namespace cairn {
namespace {

constexpr std::size_t kHeaderSize = 19;
constexpr std::size_t kChainSize = sizeof(ContentHash);
constexpr std::uint8_t kAccepted = 0;  // in the place of a refusal code

void write(ByteWriter& to, const TransactionRecord& record) {
  to.integer(record.arrival_ns);
  to.hash(record.content_hash);
  if (const auto* transaction = std::get_if<Transaction>(&record.outcome)) {
    to.integer(kAccepted);
    to.text(encode(*transaction));
    return;
  }
  const auto& refused = std::get<RefusedTransaction>(record.outcome);
  to.integer(static_cast<std::uint8_t>(refused.code));
  write_key(to, refused.key);
  to.text(refused.reason);
}

void write(ByteWriter& to, const CommandRecord& record) {
  to.integer(record.arrival_ns);
  to.text(record.operator_name);
  to.text(record.reason);
  to.text(record.command);
}

void write(ByteWriter& to, const VerdictRecord& record) {
  write_factor_name(to, record.factor);
  to.text(record.test);
  to.real(record.value);
  to.real(record.threshold);
  to.integer(static_cast<std::uint8_t>(record.state));
  to.count(record.disagreeing.size());
  for (const FactorName& factor : record.disagreeing) write_factor_name(to, factor);
}

void write(ByteWriter& to, const SolveRecord& record) {
  to.integer(record.base);
  to.text(record.settings);
  to.text(record.start);
  to.integer(record.work_limit);
  to.hash(record.estimates_hash);
  FrameTable frames;
  for (const ChangedEstimate& changed : record.changed) frames.add(changed.node.frame);
  frames.write(to);
  to.count(record.changed.size());
  for (const ChangedEstimate& changed : record.changed) {
    frames.write_node(to, changed.node);
    to.integer(static_cast<std::uint8_t>(changed.type));
    write_numbers(to, changed.numbers);
  }
}

Result<RecordBody> read_transaction(ByteReader& from) {
  TransactionRecord record;
  record.arrival_ns = from.integer<std::int64_t>();
  record.content_hash = from.hash();
  const auto code = from.integer<std::uint8_t>();
  if (code == kAccepted) {
    const std::size_t start = from.place() + 4;
    Result<Transaction> transaction = decode_transaction(from.text());
    if (!from.ok()) return RecordBody{};
    if (!transaction) {
      return Error{ErrorCode::kBadInput, transaction.error().message,
                   "record byte " + std::to_string(start) + ", " + transaction.error().place};
    }
    record.outcome = std::move(*transaction);
    return RecordBody{std::move(record)};
  }
  RefusedTransaction refused;
  refused.code = static_cast<RefusalCode>(code);
  if (code > static_cast<std::uint8_t>(RefusalCode::kDatum))
    from.fail("has a refusal code that is not a final one");
  refused.key = read_key(from);
  refused.reason = from.text();
  record.outcome = std::move(refused);
  return RecordBody{std::move(record)};
}

RecordBody read_command(ByteReader& from) {
  CommandRecord record;
  record.arrival_ns = from.integer<std::int64_t>();
  record.operator_name = from.text();
  record.reason = from.text();
  record.command = from.text();
  return record;
}

RecordBody read_verdict(ByteReader& from) {
  VerdictRecord record;
  record.factor = read_factor_name(from);
  record.test = from.text();
  record.value = from.real();
  record.threshold = from.real();
  record.state = from.enumerator(FactorState::kPending, FactorState::kQuarantined);
  const std::size_t count = from.count(25);
  record.disagreeing.reserve(count);
  for (std::size_t i = 0; i < count && from.ok(); ++i)
    record.disagreeing.push_back(read_factor_name(from));
  return record;
}

RecordBody read_solve(ByteReader& from) {
  SolveRecord record;
  record.base = from.integer<std::uint64_t>();
  record.settings = from.text();
  record.start = from.text();
  record.work_limit = from.integer<std::uint64_t>();
  record.estimates_hash = from.hash();
  FrameTable frames = FrameTable::read(from);
  const std::size_t count = from.count(17);
  record.changed.reserve(count);
  for (std::size_t i = 0; i < count && from.ok(); ++i) {
    ChangedEstimate changed;
    changed.node = frames.read_node(from);
    changed.type = from.enumerator(VariableType::kPose2, VariableType::kPoint3);
    changed.numbers = read_numbers(from);
    record.changed.push_back(std::move(changed));
  }
  frames.require_all_used(from);
  return record;
}

Result<RecordBody> read_body(ByteReader& from, std::uint8_t kind) {
  switch (static_cast<RecordKind>(kind)) {
    case RecordKind::kTransaction:
      return read_transaction(from);
    case RecordKind::kCommand:
      return read_command(from);
    case RecordKind::kVerdict:
      return read_verdict(from);
    case RecordKind::kSolve:
      return read_solve(from);
  }
  from.fail("has an unknown kind");
  return RecordBody{};
}

}  // namespace

const TransactionKey& TransactionRecord::key() const {
  if (const auto* transaction = std::get_if<Transaction>(&outcome)) return transaction->key;
  return std::get<RefusedTransaction>(outcome).key;
}

std::string encode_record(std::uint64_t number, std::uint32_t era, const RecordBody& body,
                          const ContentHash& previous) {
  std::string payload;
  ByteWriter to_payload(payload);
  std::visit([&](const auto& record) { write(to_payload, record); }, body);
  std::string bytes;
  bytes.reserve(kHeaderSize + payload.size() + kChainSize);
  ByteWriter to(bytes);
  to.integer(kRecordVersion);
  to.integer(static_cast<std::uint8_t>(body.index() + 1));
  to.integer(number);
  to.integer(era);
  to.text(payload);
  bytes.append(kChainSize, '\0');
  const ContentHash chain = chain_after(previous, bytes);
  bytes.resize(bytes.size() - kChainSize);
  to.hash(chain);
  return bytes;
}

Result<Record> decode_record(std::string_view bytes) {
  ByteReader from(bytes);
  const auto version = from.integer<std::uint16_t>();
  if (from.ok() && version != kRecordVersion) {
    return Error{ErrorCode::kBadInput,
                 "the record has format version " + std::to_string(version) +
                     ", this Cairn knows version 1 only: open it with the Cairn that wrote it",
                 "byte 0"};
  }
  Record record;
  const auto kind = from.integer<std::uint8_t>();
  record.number = from.integer<std::uint64_t>();
  record.era = from.integer<std::uint32_t>();
  const auto length = from.integer<std::uint32_t>();
  if (from.ok() && from.left() != length + kChainSize)
    from.fail("has another length than its header says");
  Result<RecordBody> body = read_body(from, kind);
  if (from.ok() && !body) return body.error();
  if (from.ok() && from.left() != kChainSize)
    from.fail("has bytes in its payload that belong to nothing");
  record.chain = from.hash();
  if (!from.ok()) {
    return Error{ErrorCode::kBadInput, "the record " + std::string(from.problem()),
                 "byte " + std::to_string(from.place())};
  }
  record.body = std::move(*body);
  return record;
}

ContentHash chain_after(const ContentHash& previous, std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  ByteWriter to(text);
  to.hash(previous);
  to.raw(bytes.substr(0, bytes.size() - std::min(bytes.size(), kChainSize)));
  return content_hash(text);
}

ContentHash chain_in(std::string_view bytes) {
  if (bytes.size() < kHeaderSize + kChainSize) return {};
  return ByteReader(bytes.substr(bytes.size() - kChainSize)).hash();
}

}  // namespace cairn
