// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/solve_trouble.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cairn/history/record_json.hpp"

namespace cairn {
namespace {

constexpr std::size_t kNamed = 3;  // of many nodes

std::string name_record(std::uint64_t number, const Journal& journal) {
  std::string name = "record " + std::to_string(number);
  const Result<Record> record = journal.read(number);
  if (!record) return name;
  if (const auto* transaction = std::get_if<TransactionRecord>(&record->body)) {
    const TransactionKey& key = transaction->key();
    name += " (" + key.source + ", sequence " + std::to_string(key.sequence) + ')';
  }
  return name;
}

std::string and_others(std::size_t count) {
  return count > kNamed ? " and " + std::to_string(count - kNamed) + " others" : "";
}

std::string describe_directions(const Eigen::MatrixXd& directions) {
  std::string text =
      std::to_string(directions.cols()) + (directions.cols() == 1 ? " direction" : " directions");
  for (Eigen::Index c = 0; c < directions.cols(); ++c) {
    text += c > 0 ? " and (" : ", (";
    for (Eigen::Index r = 0; r < directions.rows(); ++r) {
      char number[32];
      const double part = directions(r, c);
      std::snprintf(number, sizeof number, "%.3g", std::abs(part) < 1e-6 ? 0.0 : part);
      text += (r > 0 ? " " : "") + std::string(number);
    }
    text += ')';
  }
  return text;
}

}  // namespace

std::string describe(const UnsolvedPart& part, const MapHead& head, const Journal& journal) {
  const PoseGraph& map = head.graph();
  std::string text = std::to_string(part.nodes.size()) +
                     (part.nodes.size() == 1 ? " node" : " nodes") + " cannot be solved (" +
                     std::string(to_string(part.reason)) + ") and stay where they were: ";
  for (std::size_t i = 0; i < std::min(part.nodes.size(), kNamed); ++i)
    text += (i > 0 ? ", " : "") + to_string(map.nodes[part.nodes[i]].id);
  text += and_others(part.nodes.size());
  return text + "; the largest error is that of factor " +
         std::to_string(map.factors[part.worst_factor].name.index) + " in " +
         name_record(map.factors[part.worst_factor].record, journal) + ": cairn undo takes it back";
}

std::string describe(const LoopVerdict& verdict, const MapHead& head) {
  const PoseGraph& map = head.graph();
  const auto name = [&](std::uint32_t factor) {
    return "record " + std::to_string(map.factors[factor].record) + " (factor " +
           std::to_string(map.factors[factor].name.index) + ')';
  };
  const std::vector<NodeIndex>& nodes = map.factors[verdict.factor].nodes;
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, ": %.4g (limit %.4g)", verdict.value, verdict.threshold);
  std::string text = "the loop closure " + to_string(map.nodes[nodes.front()].id) + " - " +
                     to_string(map.nodes[nodes.back()].id) + " of " + name(verdict.factor) +
                     " is " + std::string(to_string(verdict.state)) + ", " + verdict.test + numbers;
  for (std::size_t i = 0; i < verdict.against.size(); ++i)
    text += (i == 0 ? "; contradicted by " : ", ") + name(verdict.against[i]);
  return text;
}

std::string describe(const std::vector<FreeNode>& free, const MapHead& head,
                     const Journal& journal) {
  std::string text;
  for (std::size_t i = 0; i < std::min(free.size(), kNamed); ++i) {
    text += (i > 0 ? "; " : "") + to_string(head.graph().nodes[free[i].node].id) + " of " +
            name_record(head.graph().nodes[free[i].node].record, journal) + " is free in " +
            describe_directions(free[i].directions);
  }
  return text + and_others(free.size()) +
         ": what no measurement determines stays where it was sent";
}

}  // namespace cairn
