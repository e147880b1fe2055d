// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"
#include "cairn/graph/pose_graph.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// The newest record format this library reads and the one it writes.
inline constexpr std::uint16_t kRecordVersion = 1;

/// A transaction that was refused for good: its sequence is used up.
struct RefusedTransaction {
  TransactionKey key;
  RefusalCode code = RefusalCode::kMalformed;  ///< a final one
  std::string reason;                          ///< as in the receipt
};

/// What a client sent and what was decided.
struct TransactionRecord {
  std::variant<Transaction, RefusedTransaction> outcome;  ///< accepted or refused
  ContentHash content_hash{};                             ///< of the bytes that were sent
  std::int64_t arrival_ns = 0;                            ///< the daemon's clock

  [[nodiscard]] const TransactionKey& key() const;
};

/// What an operator ordered.
struct CommandRecord {
  std::string operator_name;
  std::string reason;
  std::string command;
  std::int64_t arrival_ns = 0;
};

/// What the gate decided about a loop factor, and why.
struct VerdictRecord {
  FactorName factor;
  std::string test;                           ///< what was tested, e.g. "pairwise consistency"
  double value = 0.0;                         ///< of the test
  double threshold = 0.0;                     ///< it was compared with
  std::vector<FactorName> disagreeing;        ///< factors it is at odds with
  FactorState state = FactorState::kPending;  ///< from now on
};

struct ChangedEstimate {
  NodeId node;
  VariableType type = VariableType::kPose2;
  std::vector<double> numbers;  ///< as NewVariable::start, in the map frame (m, rad)
};

/// A solve that was kept: restart applies its estimates, `verify` computes them again.
struct SolveRecord {
  std::uint64_t base = 0;        ///< the record number whose state was solved
  std::string settings;          ///< method, kernels and libraries, as text
  std::string start;             ///< which start values
  std::uint64_t work_limit = 0;  ///< operations
  std::vector<ChangedEstimate> changed;
  ContentHash estimates_hash{};  ///< of all estimates after it
};

/// Stable numbers; RecordBody has the same order.
enum class RecordKind : std::uint8_t { kTransaction = 1, kCommand = 2, kVerdict = 3, kSolve = 4 };
using RecordBody = std::variant<TransactionRecord, CommandRecord, VerdictRecord, SolveRecord>;

/// One entry of the journal.
struct Record {
  std::uint64_t number = 0;  ///< 1, 2, 3, ...
  std::uint32_t era = 0;
  RecordBody body;
  ContentHash chain{};  ///< stands for this record and all before it

  [[nodiscard]] RecordKind kind() const { return static_cast<RecordKind>(body.index() + 1); }
};

/// The bytes of version 1 (backend/journal/README.md) of the record after one whose chain hash is
/// `previous` (zeros before the first).
std::string encode_record(std::uint64_t number, std::uint32_t era, const RecordBody& body,
                          const ContentHash& previous);
/// The inverse, without a look at the chain. Refuses what encode_record() cannot have made, and
/// newer versions by name. `place` of an error: byte offset.
Result<Record> decode_record(std::string_view bytes);

/// The chain hash that `bytes` must carry after `previous`. For bytes of an encoded record.
ContentHash chain_after(const ContentHash& previous, std::string_view bytes);
/// The chain hash that `bytes` do carry; zeros where they are too short.
ContentHash chain_in(std::string_view bytes);

}  // namespace cairn
