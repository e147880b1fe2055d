// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/factor_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <ranges>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/order.hpp"
#include "cairn/history/record_json.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

// The places of a record's factors: from, and behind the last.
std::pair<std::size_t, std::size_t> factors_of(std::uint64_t record, const PoseGraph& map) {
  const auto places = std::views::iota(std::size_t{0}, map.factors.size());
  const auto first = std::ranges::partition_point(
      places, [&](std::size_t f) { return map.factors[f].record < record; });
  const auto last = std::ranges::partition_point(
      places, [&](std::size_t f) { return map.factors[f].record <= record; });
  return {first - places.begin(), last - places.begin()};
}

// Names of factors that are not in the map any more do not occur.
std::map<FactorName, std::uint64_t> records_of(const std::set<FactorName>& names,
                                               const PoseGraph& map) {
  std::map<FactorName, std::uint64_t> records;
  for (std::size_t f = 0; f < map.factors.size() && records.size() < names.size(); ++f)
    if (const auto found = names.find(map.factors[f].name); found != names.end())
      records.emplace(*found, map.factors[f].record);
  return records;
}

void add_order(const CommandRecord& command, const Record& record,
               std::map<FactorName, FactorHistory>& histories) {
  const auto order = order_of(command);
  if (!order || !*order) return;
  for (const FactorEdit& edit : (*order)->edits) {
    const auto found = histories.find(edit.factor);
    if (found == histories.end()) continue;
    Json& orders = found->second.orders;
    if (!orders.empty() && orders.back()["record"] == record.number)
      orders.erase(orders.size() - 1);
    orders.push_back({{"record", record.number},
                      {"time", to_utc(command.arrival_ns)},
                      {"operator", command.operator_name},
                      {"reason", command.reason},
                      {"what", summarize(record)}});
  }
}

}  // namespace

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string name_of(const StoredFactor& factor) {
  return std::to_string(factor.record) + ':' + std::to_string(factor.name.index);
}

Result<std::vector<std::size_t>> factors_named(const std::string& name, const PoseGraph& map) {
  const std::size_t colon = name.find(':');
  const auto record = whole_number(std::string_view(name).substr(0, colon));
  const auto place = colon == std::string::npos
                         ? std::nullopt
                         : whole_number(std::string_view(name).substr(colon + 1));
  if (!record || (colon != std::string::npos && !place))
    return Error{ErrorCode::kUsage,
                 "'" + name.substr(0, 60) +
                     "' names no factor; expected RECORD or RECORD:PLACE, such as "
                     "12:0 (cairn log lists records, cairn show their factors)"};
  const auto [first, last] = factors_of(*record, map);
  if (first == last || (place && *place >= last - first))
    return Error{ErrorCode::kUsage, "there is no factor " + name + ": record " +
                                        std::to_string(*record) + " has " +
                                        std::to_string(last - first) + " factors in the map"};
  std::vector<std::size_t> places;
  for (std::size_t f = first; f < last; ++f)
    if (!place || f == first + *place) places.push_back(f);
  return places;
}

double chi2_of(const PoseGraph& map, const StoredFactor& stored) {
  Graph graph;
  NewFactor factor;
  factor.type = stored.type;
  factor.numbers = stored.numbers;
  std::vector<VariableId> ids;
  for (const NodeIndex node : stored.nodes) {
    ids.push_back({node});
    const VariableType type = map.nodes[node].type;
    const double* numbers = map.estimates[node].data();
    if (!add_variable(graph, ids.back(), type, {numbers, value_numbers(type)})) return NAN;
  }
  return add_factor(graph, factor, ids) ? compute_chi2(graph) : NAN;
}

Json json_of(const PoseGraph& map, const StoredFactor& factor) {
  Json json{{"factor", name_of(factor)},      {"type", find_factor_type(factor.type)->name},
            {"kind", to_string(factor.kind)}, {"state", to_string(factor.state)},
            {"chi2", chi2_of(map, factor)},   {"nodes", Json::array()},
            {"numbers", factor.numbers}};
  for (const NodeIndex node : factor.nodes) json["nodes"].push_back(to_string(map.nodes[node].id));
  return json;
}

std::string line_of(const PoseGraph& map, const StoredFactor& factor) {
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "  %-11s  chi2 %-12.6g",
                std::string(to_string(factor.state)).c_str(), chi2_of(map, factor));
  std::string text = name_of(factor);
  text.resize(std::max<std::size_t>(text.size(), 10), ' ');
  text += numbers + std::string(find_factor_type(factor.type)->name) + " (" +
          std::string(to_string(factor.kind)) + ')';
  for (const NodeIndex node : factor.nodes) text += ' ' + to_string(map.nodes[node].id);
  return text + '\n';
}

Result<std::map<FactorName, FactorHistory>> histories_of(const std::set<FactorName>& factors,
                                                         std::uint64_t from, const Asked& asked,
                                                         const PoseGraph& map) {
  std::map<FactorName, FactorHistory> histories;
  for (const FactorName& factor : factors) histories[factor];
  std::vector<std::pair<std::uint64_t, VerdictRecord>> verdicts;
  std::set<FactorName> disagreeing;
  const auto walked = asked.journal.for_each(from, [&](const Record& record) -> Result<void> {
    if (asked.keep_going && !asked.keep_going()) return Error{ErrorCode::kInternal, "interrupted"};
    if (const auto* command = std::get_if<CommandRecord>(&record.body))
      add_order(*command, record, histories);
    const auto* verdict = std::get_if<VerdictRecord>(&record.body);
    if (verdict == nullptr || !histories.contains(verdict->factor)) return {};
    verdicts.emplace_back(record.number, *verdict);
    disagreeing.insert(verdict->disagreeing.begin(), verdict->disagreeing.end());
    return {};
  });
  if (!walked) return walked.error();
  const auto records = records_of(disagreeing, map);
  for (const auto& [number, verdict] : verdicts) {
    Json json{{"record", number},           {"state", to_string(verdict.state)},
              {"test", verdict.test},       {"value", verdict.value},
              {"limit", verdict.threshold}, {"contradicted_by", Json::array()}};
    for (const FactorName& other : verdict.disagreeing)
      if (const auto found = records.find(other); found != records.end())
        json["contradicted_by"].push_back(std::to_string(found->second) + ':' +
                                          std::to_string(other.index));
    histories[verdict.factor].verdicts.push_back(std::move(json));
  }
  return histories;
}

std::string text_of(const FactorHistory& history) {
  std::string text;
  for (const Json& verdict : history.verdicts) {
    char line[160];
    std::snprintf(line, sizeof line, "  record %-8llu %-11s  %s: %.4g (limit %.4g)",
                  static_cast<unsigned long long>(verdict["record"].get<std::uint64_t>()),
                  verdict["state"].get<std::string>().c_str(),
                  verdict["test"].get<std::string>().substr(0, 60).c_str(),
                  verdict["value"].get<double>(), verdict["limit"].get<double>());
    text += line;
    for (std::size_t i = 0; i < verdict["contradicted_by"].size(); ++i)
      text +=
          (i == 0 ? "; contradicted by " : ", ") + verdict["contradicted_by"][i].get<std::string>();
    text += '\n';
  }
  for (const Json& order : history.orders)
    text += "  record " + std::to_string(order["record"].get<std::uint64_t>()) + "  " +
            order["time"].get<std::string>() + "  " + order["what"].get<std::string>() + '\n';
  return text;
}

}  // namespace cairn
