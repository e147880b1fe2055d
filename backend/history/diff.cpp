// SPDX-License-Identifier: BSD-3-Clause
// diff: what happened to the map between two revisions.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cairn/history/question.hpp"
#include "cairn/history/record_json.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

struct Move {
  NodeIndex node = 0;
  double distance_m = 0.0, angle_rad = 0.0;
};

struct Difference {
  std::vector<std::string> variables_added, factors_added;
  std::map<std::string, std::vector<std::string>> factors_changed;  ///< by new state
  std::vector<Move> moved;                                          ///< by node
};

Move move_between(const PoseGraph& a, const PoseGraph& b, NodeIndex node) {
  const Estimate &x = a.estimates[node], &y = b.estimates[node];
  Move move{node, std::hypot(y[0] - x[0], y[1] - x[1]), 0.0};
  switch (a.nodes[node].type) {
    case VariableType::kPose2:
      move.angle_rad = std::abs(std::remainder(y[2] - x[2], 2.0 * M_PI));
      break;
    case VariableType::kPose3: {
      move.distance_m = std::hypot(move.distance_m, y[2] - x[2]);
      // |q_a^-1 q_b|: of the imaginary part and of the real one.
      const double w = x[3] * y[3] + x[4] * y[4] + x[5] * y[5] + x[6] * y[6];
      move.angle_rad = 2.0 * std::atan2(std::sqrt(std::max(0.0, 1.0 - w * w)), std::abs(w));
      break;
    }
    case VariableType::kPoint2:
      break;
    case VariableType::kPoint3:
      move.distance_m = std::hypot(move.distance_m, y[2] - x[2]);
  }
  return move;
}

Difference compare(const PoseGraph& a, const PoseGraph& b) {
  Difference difference;
  for (NodeIndex node = 0; node < b.nodes.size(); ++node) {
    if (node >= a.nodes.size())
      difference.variables_added.push_back(to_string(b.nodes[node].id));
    else if (a.estimates[node] != b.estimates[node])
      difference.moved.push_back(move_between(a, b, node));
  }
  for (std::size_t f = 0; f < b.factors.size(); ++f) {
    const StoredFactor& now = b.factors[f];
    const bool is_new = f >= a.factors.size();
    if (is_new) difference.factors_added.push_back(to_string(now.name));
    const FactorState before = is_new ? FactorState::kCommitted : a.factors[f].state;
    if (now.state != before && !(is_new && now.state == FactorState::kPending))
      difference.factors_changed[std::string(to_string(now.state))].push_back(to_string(now.name));
  }
  return difference;
}

const Move* largest(const std::vector<Move>& moves, double Move::*size) {
  const auto found = std::max_element(
      moves.begin(), moves.end(), [&](const Move& a, const Move& b) { return a.*size < b.*size; });
  return found == moves.end() ? nullptr : &*found;
}

std::string list(const char* what, const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 8;
  std::string text = std::to_string(names.size()) + ' ' + what;
  for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
    text += (i == 0 ? ": " : ", ") + names[i];
  return text + (names.size() > kShown ? ", ...\n" : "\n");
}

std::string text_of(const Difference& difference, const PoseGraph& b) {
  std::string text = list("variables added", difference.variables_added);
  text += list("factors added", difference.factors_added);
  for (const auto& [state, factors] : difference.factors_changed)
    text += list(("factors now " + state).c_str(), factors);
  text += std::to_string(difference.moved.size()) + " estimates moved";
  char number[64];
  if (const Move* far = largest(difference.moved, &Move::distance_m)) {
    std::snprintf(number, sizeof number, ", at most %.6g m (", far->distance_m);
    text += number + to_string(b.nodes[far->node].id) + ')';
  }
  if (const Move* turned = largest(difference.moved, &Move::angle_rad);
      turned && turned->angle_rad > 0) {
    std::snprintf(number, sizeof number, " and %.6g rad (", turned->angle_rad);
    text += number + to_string(b.nodes[turned->node].id) + ')';
  }
  return text + '\n';
}

Json json_of(const Difference& difference, const PoseGraph& a, const PoseGraph& b) {
  Json json{{"schema_version", 1},
            {"from", a.graph_revision.number},
            {"to", b.graph_revision.number},
            {"variables_added", difference.variables_added},
            {"factors_added", difference.factors_added},
            {"factors_changed", difference.factors_changed}};
  const auto move = [&](double Move::*size) -> Json {
    const Move* found = largest(difference.moved, size);
    if (found == nullptr) return nullptr;
    return {{"node", to_string(b.nodes[found->node].id)}, {"size", found->*size}};
  };
  json["moved"] = {{"count", difference.moved.size()},
                   {"largest_m", move(&Move::distance_m)},
                   {"largest_rad", move(&Move::angle_rad)}};
  return json;
}

}  // namespace

Result<std::string> answer_diff(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"from", "to", "json"}); !known)
    return known.error();
  const std::uint64_t from = question.number("from", 0), to = question.number("to", 0);
  if (from > to) {
    return Error{ErrorCode::kUsage, "the first revision is the older one; try diff " +
                                        std::to_string(to) + ' ' + std::to_string(from)};
  }
  const auto maps = maps_at(asked.journal, {from, to}, asked.keep_going);
  if (!maps) return maps.error();
  const PoseGraph &a = maps->front(), &b = maps->back();
  const Difference difference = compare(a, b);
  return question.flag("json") ? dump(json_of(difference, a, b)) + '\n' : text_of(difference, b);
}

}  // namespace cairn
