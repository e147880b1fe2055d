// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/history/question.hpp"

namespace cairn {

/// Nothing where the text is anything else.
std::optional<std::uint64_t> whole_number(std::string_view text);
/// "12:0": record and place, as operators name a factor.
std::string name_of(const StoredFactor& factor);
/// Places in PoseGraph::factors of what "12:3", or "12" (all of a record's), names; in order.
/// kUsage where it names nothing.
Result<std::vector<std::size_t>> factors_named(const std::string& name, const PoseGraph& map);

/// What a factor costs at the newest estimates; NaN where that is no number.
double chi2_of(const PoseGraph& map, const StoredFactor& factor);
/// Name, type, kind, state, chi2, nodes and numbers.
nlohmann::ordered_json json_of(const PoseGraph& map, const StoredFactor& factor);
/// The same, but the numbers, on a line.
std::string line_of(const PoseGraph& map, const StoredFactor& factor);

/// What gate and operators ever said of a factor, oldest first.
struct FactorHistory {
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  nlohmann::ordered_json orders = nlohmann::ordered_json::array();
};
/// Of some factors, by name. Reads the journal from the record `from` on.
Result<std::map<FactorName, FactorHistory>> histories_of(const std::set<FactorName>& factors,
                                                         std::uint64_t from, const Asked& asked,
                                                         const PoseGraph& map);
/// A line for each verdict and order.
std::string text_of(const FactorHistory& history);

}  // namespace cairn
