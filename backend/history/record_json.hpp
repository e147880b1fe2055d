// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cairn/graph/pose_graph.hpp"
#include "cairn/journal/record.hpp"

namespace cairn {

/// Everything a record holds, in words and numbers.
nlohmann::ordered_json to_json(const Record& record);
/// The same facts in a few words.
std::string summarize(const Record& record);
/// Its kind in one word: transaction, refusal, command, verdict or solve.
std::string kind_of(const Record& record);
/// Null for solves, which no source sent.
const TransactionKey* key_of(const Record& record);
/// Arrival; nothing for verdicts and solves.
std::optional<std::int64_t> time_of(const Record& record);

std::string_view to_string(FactorState state);
std::string_view to_string(FactorKind kind);
/// "source/sequence#index", for people: epochs are random.
std::string to_string(const FactorName& factor);
/// "2026-01-31T08:15:00.250Z"
std::string to_utc(std::int64_t time_ns);
/// The inverse, the fraction of any length; nothing where the text is no such time.
std::optional<std::int64_t> from_utc(const std::string& text);

}  // namespace cairn
