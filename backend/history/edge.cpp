// SPDX-License-Identifier: BSD-3-Clause
// edge show: factors of a record as they stand in the map now; edge worst: those that fit worst.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/question.hpp"
#include "cairn/history/record_json.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

// What it costs at the newest estimates.
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

Json describe(const PoseGraph& map, std::size_t place, const std::string& name) {
  const StoredFactor& factor = map.factors[place];
  Json json{{"factor", name},
            {"type", find_factor_type(factor.type)->name},
            {"kind", to_string(factor.kind)},
            {"state", to_string(factor.state)},
            {"chi2", chi2_of(map, factor)},
            {"nodes", Json::array()},
            {"numbers", factor.numbers}};
  for (const NodeIndex node : factor.nodes) json["nodes"].push_back(to_string(map.nodes[node].id));
  return json;
}

std::string line_of(const Json& json) {
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "  %-11s  chi2 %-12.6g",
                json["state"].get<std::string>().c_str(),
                json["chi2"].is_number() ? json["chi2"].get<double>() : NAN);
  std::string text = json["factor"].get<std::string>();
  text.resize(std::max<std::size_t>(text.size(), 10), ' ');
  text += numbers + json["type"].get<std::string>() + " (" + json["kind"].get<std::string>() + ')';
  for (const Json& node : json["nodes"]) text += ' ' + node.get<std::string>();
  return text + '\n';
}

// Places of the committed factors with the largest chi2, the largest first.
std::vector<std::size_t> worst_factors(const PoseGraph& map, std::size_t limit) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t place = 0; place < map.factors.size(); ++place) {
    if (map.factors[place].state != FactorState::kCommitted) continue;
    const double chi2 = chi2_of(map, map.factors[place]);
    ranked.emplace_back(std::isnan(chi2) ? INFINITY : chi2, place);
  }
  limit = std::min(limit, ranked.size());
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(limit);
  std::partial_sort(ranked.begin(), end, ranked.end(), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  });
  std::vector<std::size_t> worst;
  for (auto at = ranked.begin(); at != end; ++at) worst.push_back(at->second);
  return worst;
}

// Numbers of the records that brought these factors, by transaction.
Result<std::map<TransactionKey, std::uint64_t>> records_of(const PoseGraph& map,
                                                           const std::vector<std::size_t>& places,
                                                           const Asked& asked) {
  std::map<TransactionKey, std::uint64_t> numbers;
  for (const std::size_t place : places) numbers[map.factors[place].name.transaction] = 0;
  const Error stop{ErrorCode::kInternal, "interrupted"};
  const auto walked = asked.journal.for_each(1, [&](const Record& record) -> Result<void> {
    if (asked.keep_going && !asked.keep_going()) return stop;
    const TransactionKey* key = key_of(record);
    if (key == nullptr) return {};
    if (const auto known = numbers.find(*key); known != numbers.end())
      known->second = record.number;
    return {};
  });
  if (!walked) return walked.error();
  return numbers;
}

std::string name_in(std::uint64_t record, const StoredFactor& factor) {
  return std::to_string(record) + ':' + std::to_string(factor.name.index);
}

}  // namespace

Result<std::string> answer_edge_worst(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"limit", "json"}); !known) return known.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  const auto worst = worst_factors(*map, question.number("limit", 10));
  const auto records = records_of(*map, worst, asked);
  if (!records) return records.error();
  std::string text;
  Json all = Json::array();
  for (const std::size_t place : worst) {
    const StoredFactor& factor = map->factors[place];
    all.push_back(describe(*map, place, name_in(records->at(factor.name.transaction), factor)));
    text += line_of(all.back());
  }
  return question.flag("json") ? dump(all) + '\n' : text;
}

Result<std::string> answer_edge_show(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"record", "json"}); !known) return known.error();
  const std::uint64_t number = question.number("record", 0);
  const Result<Record> record = find_record(asked.journal, number);
  if (!record) return record.error();
  const TransactionKey* key = key_of(*record);
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  std::string text;
  Json all = Json::array();
  for (std::size_t place = 0; key != nullptr && place < map->factors.size(); ++place) {
    const FactorName& name = map->factors[place].name;
    if (name.transaction != *key) continue;
    all.push_back(describe(*map, place, name_in(number, map->factors[place])));
    text += line_of(all.back());
  }
  if (all.empty())
    return Error{ErrorCode::kUsage,
                 "record " + std::to_string(number) + " brought no factors to the map"};
  return question.flag("json") ? dump(all) + '\n' : text;
}

}  // namespace cairn
