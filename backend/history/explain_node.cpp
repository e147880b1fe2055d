// SPDX-License-Identifier: BSD-3-Clause
// explain node: where a node is, how well that is known, and what says so.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/factor_text.hpp"
#include "cairn/history/question.hpp"
#include "cairn/history/record_json.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/marginals.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 40;  // factors, for people

// "robot/epoch/index", or "record:place": the place-th one that a record brought.
Result<NodeIndex> node_named(const std::string& name, const PoseGraph& map) {
  const std::size_t colon = name.rfind(':');
  const auto record = whole_number(std::string_view(name).substr(0, colon));
  const auto place = colon == std::string::npos
                         ? std::nullopt
                         : whole_number(std::string_view(name).substr(colon + 1));
  std::uint64_t count = 0;
  for (NodeIndex node = 0; node < map.nodes.size(); ++node) {
    const bool in_record = record && place && map.nodes[node].record == *record;
    if ((in_record && count++ == *place) || to_string(map.nodes[node].id) == name) return node;
  }
  return Error{ErrorCode::kUsage,
               "there is no node '" + name.substr(0, 120) +
                   "' in the map; expected ROBOT/EPOCH/INDEX or RECORD:PLACE, such as 12:0 (cairn "
                   "show lists a record's variables)"};
}

// In the tangent space of the node; degrees where it is an angle.
std::vector<const char*> units_of(VariableType type) {
  switch (type) {
    case VariableType::kPose2:
      return {"x m", "y m", "yaw deg"};
    case VariableType::kPose3:
      return {"x m", "y m", "z m", "about x deg", "about y deg", "about z deg"};
    case VariableType::kPoint2:
      return {"x m", "y m"};
    case VariableType::kPoint3:
      break;
  }
  return {"x m", "y m", "z m"};
}

// Of the estimate that everything that takes part gives.
std::optional<Eigen::MatrixXd> covariance_of(const PoseGraph& map, NodeIndex node,
                                             const KeepGoing& keep_going) {
  const CanonicalOrder order(map,
                             [&](std::uint32_t f) { return takes_part(map.factors[f].state); });
  const auto place = std::find(order.nodes.begin(), order.nodes.end(), node);
  if (place == order.nodes.end()) return std::nullopt;
  const auto slot = static_cast<VariableSlot>(place - order.nodes.begin());
  const SettledEstimate settled =
      settle(map, order, {.gate = Gate::kOpen, .keep_going = keep_going});
  if (!settled.summary.usable()) return std::nullopt;
  const auto marginals =
      Marginals::compute(settled.graph, optimizer_options({.keep_going = keep_going}));
  if (!marginals) return std::nullopt;
  return marginals->covariance(slot);
}

void put_covariance(const std::optional<Eigen::MatrixXd>& covariance, Json& json) {
  json["covariance"] = nullptr;
  json["sigma"] = nullptr;
  if (!covariance) return;
  json["covariance"] = Json::array();
  json["sigma"] = Json::array();
  for (Eigen::Index row = 0; row < covariance->rows(); ++row) {
    json["sigma"].push_back(std::sqrt((*covariance)(row, row)));
    for (Eigen::Index column = row; column < covariance->cols(); ++column)
      json["covariance"].push_back((*covariance)(row, column));
  }
}

std::string text_of_sigmas(const Json& sigmas, VariableType type) {
  if (sigmas.is_null()) return "unknown: no factor ties it, or the map cannot be solved";
  const std::vector<const char*> units = units_of(type);
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const bool angle = std::string_view(units[i]).ends_with("deg");
    char part[64];
    if (!sigmas[i].is_number() || std::isnan(sigmas[i].get<double>()))
      std::snprintf(part, sizeof part, "%s free", units[i]);
    else
      std::snprintf(part, sizeof part, "%s %.3g", units[i],
                    sigmas[i].get<double>() * (angle ? 180.0 / M_PI : 1.0));
    text += (i == 0 ? "" : ", ") + std::string(part);
  }
  return text;
}

// What is out first, then what fits worst.
std::vector<std::size_t> factors_at(NodeIndex node, const PoseGraph& map) {
  std::vector<std::tuple<bool, double, std::size_t>> ranked;
  for (std::size_t f = 0; f < map.factors.size(); ++f) {
    const std::vector<NodeIndex>& nodes = map.factors[f].nodes;
    if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) continue;
    const double chi2 = chi2_of(map, map.factors[f]);
    ranked.emplace_back(takes_part(map.factors[f].state), std::isnan(chi2) ? -INFINITY : -chi2, f);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> factors;
  for (const auto& [in, chi2, f] : ranked) factors.push_back(f);
  return factors;
}

std::string text_of(const PoseGraph& map, NodeIndex node, const std::vector<std::size_t>& factors,
                    const std::map<FactorName, FactorHistory>& histories, const Json& json) {
  const StoredNode& stored = map.nodes[node];
  std::string text = "node       " + to_string(stored.id) + " (" +
                     std::string(to_string(stored.type)) + ") of record " +
                     std::to_string(stored.record) + "\nestimate   ";
  for (const Json& number : json["estimate"]) {
    char part[32];
    std::snprintf(part, sizeof part, "%.9g ", number.get<double>());
    text += part;
  }
  text += "\nsigma      " + text_of_sigmas(json["sigma"], stored.type) + "\nfactors    " +
          std::to_string(factors.size()) + '\n';
  for (std::size_t i = 0; i < std::min(factors.size(), kShown); ++i) {
    const StoredFactor& factor = map.factors[factors[i]];
    text += "  " + line_of(map, factor);
    if (takes_part(factor.state)) continue;
    FactorHistory last = histories.at(factor.name);
    if (last.verdicts.size() > 1) last.verdicts = Json::array({last.verdicts.back()});
    text += text_of(last);
  }
  if (factors.size() > kShown)
    text += "  and " + std::to_string(factors.size() - kShown) + " that fit better (--json)\n";
  return text;
}

}  // namespace

Result<std::string> answer_explain_node(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"node", "json"}); !known) return known.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  const Result<NodeIndex> node = node_named(question.text("node"), *map);
  if (!node) return node.error();
  const StoredNode& stored = map->nodes[*node];
  const std::vector<std::size_t> factors = factors_at(*node, *map);
  std::set<FactorName> names;
  for (const std::size_t f : factors) names.insert(map->factors[f].name);
  const auto histories = histories_of(names, stored.record, asked, *map);
  if (!histories) return histories.error();
  const auto* numbers = map->estimates[*node].data();
  Json json{{"node", to_string(stored.id)},
            {"type", to_string(stored.type)},
            {"record", stored.record},
            {"stamp_ns", stored.stamp_ns},
            {"estimate", std::vector(numbers, numbers + value_numbers(stored.type))}};
  put_covariance(covariance_of(*map, *node, asked.keep_going), json);
  if (asked.keep_going && !asked.keep_going()) return Error{ErrorCode::kInternal, "interrupted"};
  if (!question.flag("json")) return text_of(*map, *node, factors, *histories, json);
  json["factors"] = Json::array();
  for (const std::size_t f : factors) {
    json["factors"].push_back(json_of(*map, map->factors[f]));
    json["factors"].back()["verdicts"] = histories->at(map->factors[f].name).verdicts;
  }
  return dump(json) + '\n';
}

}  // namespace cairn
