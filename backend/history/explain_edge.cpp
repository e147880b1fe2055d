// SPDX-License-Identifier: BSD-3-Clause
// explain edge: what was ever said of a factor, and what the map would be with it and without.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/factor_text.hpp"
#include "cairn/history/question.hpp"
#include "cairn/history/record_json.hpp"
#include "cairn/replay/estimate.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/contradiction.hpp"
#include "cairn/solver/innovation.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 8;  // of long lists, for people

const Error kInterrupted{ErrorCode::kInternal, "interrupted"};

// A factor, and the map with everything that takes part but it.
class Case {
 public:
  Case(const PoseGraph& map, std::size_t place, const KeepGoing& keep_going)
      : map_(map), place_(place), keep_going_(keep_going) {}

  // Places of the map, keys of the answer.
  void put_chi2(Json& json) {
    without_ = solve(false);
    const SettledEstimate with = solve(true);
    const auto chi2 = [](const SettledEstimate& solved) {
      return solved.summary.usable() ? Json(solved.summary.final_chi2) : Json();
    };
    json["map"] = {{"chi2_without", chi2(without_)}, {"chi2_with", chi2(with)}};
  }

  // How far it is from where everything else puts its nodes.
  void put_distance(Json& json) {
    json["tied_by_others"] = tied_by_others();
    json["off"] = nullptr;
    if (!without_.summary.usable() || !tied_by_others()) return;
    const auto [graph, factor] = graph_with_it();
    const auto marginals =
        Marginals::compute(without_.graph, optimizer_options({.keep_going = keep_going_}));
    if (!marginals) return;
    const auto innovation = innovation_outside(graph, factor, *marginals);
    if (!innovation) return;
    json["off"] = {{"sigma", std::sqrt(innovation->chi2)},
                   {"chi2", innovation->chi2},
                   {"dimension", innovation->dimension}};
    put_places(json["off"]);
  }

  // The smallest set of edges that say otherwise.
  void put_contradiction(Json& json) {
    json["contradiction"] = nullptr;
    const auto [graph, factor] = graph_with_it();
    const auto found = find_contradiction(graph, place_in_order(), keep_going_);
    if (!found) return;
    const CanonicalOrder order = order_of(true);
    Json factors = Json::array();
    for (const std::size_t place : found->factors) {
      const StoredFactor& stored = map_.factors[order.factors[place]];
      factors.push_back({{"factor", name_of(stored)}, {"kind", to_string(stored.kind)}});
    }
    json["contradiction"] = {
        {"factors", std::move(factors)}, {"chi2", found->chi2}, {"limit", found->threshold}};
  }

  // What the gate would make of all loops, were this one in the map whatever it says; or out.
  void put_alternative(Json& json) const {
    const bool is_in = takes_part(map_.factors[place_].state);
    PoseGraph other = map_;
    other.factors.edit(place_).state = is_in ? FactorState::kDisabled : FactorState::kTrusted;
    const SettledEstimate settled = settle(other, {.keep_going = keep_going_});
    Json& alternative = json[is_in ? "if_disabled" : "if_trusted"];
    if (!settled.summary.usable()) return;
    alternative = {{"chi2", settled.summary.final_chi2},
                   {"leaves_out", Json::array()},
                   {"takes_in", Json::array()}};
    for (const LoopVerdict& verdict : settled.verdicts) {
      const StoredFactor& loop = map_.factors[verdict.factor];
      if (takes_part(verdict.state) != takes_part(loop.state))
        alternative[takes_part(verdict.state) ? "takes_in" : "leaves_out"].push_back(name_of(loop));
    }
  }

 private:
  [[nodiscard]] CanonicalOrder order_of(bool with) const {
    return CanonicalOrder(map_, [&](std::uint32_t f) {
      return f == place_ ? with : takes_part(map_.factors[f].state);
    });
  }
  [[nodiscard]] SettledEstimate solve(bool with) const {
    return settle(map_, order_of(with), {.gate = Gate::kOpen, .keep_going = keep_going_});
  }
  [[nodiscard]] std::size_t place_in_order() const {
    const CanonicalOrder order = order_of(true);
    return static_cast<std::size_t>(std::find(order.factors.begin(), order.factors.end(), place_) -
                                    order.factors.begin());
  }
  // At the solution without it.
  [[nodiscard]] std::pair<Graph, FactorRef> graph_with_it() const {
    Graph graph = canonical_graph(map_, order_of(true));
    if (without_.summary.usable()) graph.values() = without_.graph.values();
    const FactorRef factor = graph.factors()[place_in_order()];
    return {std::move(graph), factor};
  }

  // What is absolute ties to one node more.
  [[nodiscard]] bool tied_by_others() const {
    const std::size_t frame = map_.nodes.size();
    DisjointSets sets(frame + 1);
    const auto tie = [&](const StoredFactor& factor) {
      if (factor.nodes.size() == 1) sets.join(factor.nodes[0], frame);
      for (const NodeIndex node : factor.nodes) sets.join(factor.nodes[0], node);
    };
    for (std::size_t f = 0; f < map_.factors.size(); ++f)
      if (f != place_ && takes_part(map_.factors[f].state)) tie(map_.factors[f]);
    const std::vector<NodeIndex>& nodes = map_.factors[place_].nodes;
    return sets.root(nodes.front()) == (nodes.size() == 1 ? sets.root(frame) : sets.root(nodes[1]));
  }

  // Where it puts its second node, seen from where the map has its first.
  void put_places(Json& json) const {
    const StoredFactor& factor = map_.factors[place_];
    if (factor.nodes.size() != 2) return;
    const auto by_map = [&](NodeIndex node) {
      const auto& nodes = without_.order.nodes;
      const auto slot = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
      return to_estimate(describe_value(without_.graph, static_cast<std::uint32_t>(slot)));
    };
    const Estimate there = by_map(factor.nodes[1]);
    const auto claimed = compose(by_map(factor.nodes[0]), factor.type, factor.numbers, true);
    if (!claimed) return;
    const VariableType type = map_.nodes[factor.nodes[1]].type;
    const PoseDistance apart = distance(type, *claimed, there);
    const auto numbers = [&](const Estimate& estimate) {
      return std::vector(estimate.begin(), estimate.begin() + value_numbers(type));
    };
    json["distance_m"] = apart.translation_m;
    json["angle_rad"] = apart.rotation_rad;
    json["node"] = to_string(map_.nodes[factor.nodes[1]].id);
    json["by_the_map"] = numbers(there);
    json["by_the_edge"] = numbers(*claimed);
  }

  const PoseGraph& map_;
  std::size_t place_;
  const KeepGoing& keep_going_;
  SettledEstimate without_;
};

std::string text(const char* format, auto... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string names(const Json& list) {
  std::string text;
  for (std::size_t i = 0; i < std::min(list.size(), kShown); ++i)
    text += (i == 0 ? "" : ", ") + list[i].get<std::string>();
  return text + (list.size() > kShown ? ", ..." : "");
}

std::string coordinates(const Json& pose) {
  const std::size_t shown = pose.size() == 7 || pose.size() == 3 ? 3 : pose.size();
  std::string all;
  for (std::size_t i = 0; i < shown; ++i)
    all += (i == 0 ? "" : " ") + text("%.4g", pose[i].get<double>());
  return '(' + all + ')';
}

std::string text_of_distance(const Json& json) {
  if (!json["tied_by_others"].get<bool>())
    return "off        nothing else ties its ends together: the map says nothing against it\n";
  const Json& off = json["off"];
  if (off.is_null()) return "off        cannot be said: the map without it cannot be solved\n";
  std::string all =
      text("off        %.3g sigma (in %d directions: squared distance %.4g)",
           off["sigma"].get<double>(), off["dimension"].get<int>(), off["chi2"].get<double>());
  if (off.contains("node"))
    all += text(", %.4g m and %.3g deg\n", off["distance_m"].get<double>(),
                off["angle_rad"].get<double>() * 180.0 / M_PI) +
           "           it puts " + off["node"].get<std::string>() + " at " +
           coordinates(off["by_the_edge"]) + ", the map without it at " +
           coordinates(off["by_the_map"]);
  return all + '\n';
}

std::string text_of_contradiction(const Json& found) {
  if (found.is_null()) return "against    no chain of edges contradicts it by itself\n";
  Json loops = Json::array();
  for (const Json& factor : found["factors"])
    if (factor["kind"] != to_string(FactorKind::kOdometry)) loops.push_back(factor["factor"]);
  const std::size_t count = found["factors"].size(), odometry = count - loops.size();
  std::string all = text("against    %zu edges (chi2 of the cycle %.4g, limit %.4g): ", count,
                         found["chi2"].get<double>(), found["limit"].get<double>());
  all += names(loops);
  if (odometry > 0)
    all += (loops.empty() ? "" : " and ") + std::to_string(odometry) + " of odometry";
  return all + '\n';
}

std::string text_of_alternative(const Json& json) {
  const bool is_in = json.contains("if_disabled");
  const Json& other = json[is_in ? "if_disabled" : "if_trusted"];
  const std::string label = is_in ? "disabled   " : "trusted    ";
  if (other.is_null()) return label + "the map could not be solved\n";
  std::string all = label + text("chi2 would be %.6g", other["chi2"].get<double>());
  for (const auto& [key, what] :
       {std::pair("leaves_out", "leave out"), std::pair("takes_in", "take in")})
    if (const Json& loops = other[key]; !loops.empty())
      all += text(", the gate would %s %zu: ", what, loops.size()) + names(loops);
  return all + '\n';
}

std::string text_of(const PoseGraph& map, const StoredFactor& factor, const FactorHistory& history,
                    const Json& json) {
  const auto chi2 = [](const Json& number) {
    return number.is_null() ? "cannot be solved" : text("%.6g", number.get<double>());
  };
  const TransactionKey& key = factor.name.transaction;
  std::string all = "edge       " + line_of(map, factor);
  all += "sent       by " + key.source + ", sequence " + std::to_string(key.sequence) + '\n';
  const bool said = !history.verdicts.empty() || !history.orders.empty();
  all += said ? "history\n" + text_of(history) : "history    no verdicts, no orders\n";
  all += "map        chi2 without it " + chi2(json["map"]["chi2_without"]) + ", with it " +
         chi2(json["map"]["chi2_with"]) + '\n';
  all += text_of_distance(json);
  if (!json.contains("contradiction")) return all;
  return all + text_of_contradiction(json["contradiction"]) + text_of_alternative(json);
}

}  // namespace

Result<std::string> answer_explain_edge(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"factor", "json"}); !known) return known.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  const auto places = factors_named(question.text("factor"), *map);
  if (!places) return places.error();
  if (places->size() != 1)
    return Error{ErrorCode::kUsage,
                 "record " + question.text("factor") + " has " + std::to_string(places->size()) +
                     " factors; name one, such as " + name_of(map->factors[places->front()])};
  const StoredFactor& factor = map->factors[places->front()];
  const auto histories = histories_of({factor.name}, factor.record, asked, *map);
  if (!histories) return histories.error();
  const FactorHistory& history = histories->at(factor.name);
  Json json = json_of(*map, factor);
  json["source"] = factor.name.transaction.source;
  json["sequence"] = factor.name.transaction.sequence;
  json["verdicts"] = history.verdicts;
  json["orders"] = history.orders;
  Case edge(*map, places->front(), asked.keep_going);
  edge.put_chi2(json);
  edge.put_distance(json);
  if (is_gated(factor.type, factor.kind)) {
    edge.put_contradiction(json);
    edge.put_alternative(json);
  }
  if (asked.keep_going && !asked.keep_going()) return kInterrupted;
  return question.flag("json") ? dump(json) + '\n' : text_of(*map, factor, history, json);
}

}  // namespace cairn
