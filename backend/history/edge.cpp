// SPDX-License-Identifier: BSD-3-Clause
// edge show: factors of a record as they stand in the map now.
#include <algorithm>
#include <cmath>
#include <cstdio>

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

}  // namespace

Result<std::string> answer_edge_show(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"record", "json"}); !known) return known.error();
  const std::uint64_t number = question.number("record", 0);
  const std::uint64_t newest = asked.journal.head().revision.number;
  if (number == 0 || number > newest)
    return Error{ErrorCode::kUsage, "there is no record " + std::to_string(number) +
                                        "; expected one of 1 to " + std::to_string(newest)};
  const Result<Record> record = asked.journal.read(number);
  if (!record) return record.error();
  const TransactionKey* key = key_of(*record);
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  std::string text;
  Json all = Json::array();
  for (std::size_t place = 0; key != nullptr && place < map->factors.size(); ++place) {
    const FactorName& name = map->factors[place].name;
    if (name.transaction != *key) continue;
    all.push_back(describe(*map, place, std::to_string(number) + ':' + std::to_string(name.index)));
    text += line_of(all.back());
  }
  if (all.empty())
    return Error{ErrorCode::kUsage,
                 "record " + std::to_string(number) + " brought no factors to the map"};
  return question.flag("json") ? dump(all) + '\n' : text;
}

}  // namespace cairn
