// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"
#include "cairn/graph/kinds.hpp"
#include "cairn/graph/node_id.hpp"

namespace cairn {

/// Names a transaction for ever: the n-th that a client program (its spool) sent.
struct TransactionKey {
  std::string source;          ///< the client's name, 1 to 64 bytes
  std::uint64_t epoch = 0;     ///< random, made with the client's spool
  std::uint64_t sequence = 0;  ///< 1, 2, 3, ...

  friend auto operator<=>(const TransactionKey&, const TransactionKey&) = default;
  friend bool operator==(const TransactionKey&, const TransactionKey&) = default;
};

/// A variable and where to start it. Numbers by type: pose2 x y theta; pose3 x y z qx qy qz qw;
/// point2 x y; point3 x y z (m, rad).
struct NewVariable {
  NodeId node;
  VariableType type = VariableType::kPose2;
  std::vector<double> start;     ///< in the map frame of the robot; a guess
  std::int64_t stamp_ns = 0;     ///< of the sensor; a label, never differentiated
  std::vector<double> odometry;  ///< T_odom_body, as `start`; empty where there is none
};

/// What kind of measurement, by its stable number (wire and journal); names are the factors' kName.
/// See factors/factor_codec.hpp.
enum class FactorType : std::uint16_t {};

struct NewFactor {
  FactorType type{};
  FactorKind kind = FactorKind::kOther;
  std::vector<NodeId> nodes;    ///< in the order of the factor's signature
  std::vector<double> numbers;  ///< measurement, sensor offsets, upper triangle of the information
  std::vector<ContentHash> payloads{};  ///< scans or images it was made from
};

/// Names one factor: the n-th of a transaction.
struct FactorName {
  TransactionKey transaction;
  std::uint32_t index = 0;

  friend auto operator<=>(const FactorName&, const FactorName&) = default;
  friend bool operator==(const FactorName&, const FactorName&) = default;
};

/// The last two are an operator's only: no transaction carries them.
enum class FactorChange : std::uint8_t {
  kDisable = 0,
  kEnable = 1,
  kRemove = 2,
  kTrust = 3,  ///< a loop closure is in, whatever the gate says
  kDoubt = 4,  ///< the gate decides about it again
};

struct FactorEdit {
  FactorName factor;
  FactorChange change = FactorChange::kDisable;
};

/// The only thing a front-end sends: applied whole or not at all.
struct Transaction {
  TransactionKey key;
  std::int64_t sent_ns = 0;  ///< the client's clock when it was first submitted
  std::vector<NewVariable> variables;
  std::vector<NewFactor> factors;
  std::vector<FactorEdit> edits;
};

/// Version 1 of the canonical bytes, the same for journal, hash and spool; little-endian. Grammar
/// in backend/graph/README.md.
std::string encode(const Transaction& transaction);
/// The inverse. Refuses every string that encode() cannot have made (place: byte offset).
Result<Transaction> decode_transaction(std::string_view bytes);

/// Why a transaction was not applied.
enum class RefusalCode : std::uint8_t {
  // Final: journaled, the sequence is used up.
  kMalformed = 1,        ///< breaks a rule of the format: sizes, types, self edges, empty names
  kNotFinite = 2,        ///< NaN or infinity
  kInformation = 3,      ///< not symmetric positive semidefinite
  kUnknownVariable = 4,  ///< names a node or factor that does not exist
  kConflict = 5,         ///< the key is taken by other content, or a node exists already
  kStale = 6,            ///< before what is kept, or of an epoch that a newer one closed
  kForeignSource = 7,    ///< another writer lives under this name; not journaled, offered again
  kVersion = 8,          ///< of a newer format than this daemon knows
  kDatum = 9,            ///< positions of GNSS at another datum than the map's
  // Retryable: not journaled, the sequence stays free.
  kStorageFull = 100,
  kBusy = 101,
  kOverBudget = 102,
};
constexpr bool is_retryable(RefusalCode code) { return static_cast<int>(code) >= 100; }
std::string_view to_string(RefusalCode code);  ///< "unknown variable", ...

/// Names a state of everything: which store, which era of it (raised by damage), how many records.
struct Revision {
  std::uint64_t store = 0;  ///< random, made with the store
  std::uint32_t era = 0;
  std::uint64_t number = 0;  ///< 0: empty

  friend auto operator<=>(const Revision&, const Revision&) = default;
  friend bool operator==(const Revision&, const Revision&) = default;
};
std::string to_string(const Revision& revision);  ///< "8f3a...:0:1234"

/// The daemon's answer to one transaction. An acceptance is durable.
struct Receipt {
  TransactionKey key;
  Revision revision;                     ///< of the acceptance or journaled refusal; else the head
  std::optional<RefusalCode> refusal{};  ///< nothing: accepted
  std::string reason{};                  ///< for people: what was found, what was expected
};

}  // namespace cairn
