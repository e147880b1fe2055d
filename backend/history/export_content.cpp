// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/export_content.hpp"

#include <unordered_map>
#include <unordered_set>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/io/graph_file.hpp"

namespace cairn {
namespace {

bool is_from_file(const NodeId& node) { return node.frame.epoch == 0; }

GraphDocument to_document(const ExportContent& content, const std::vector<VariableId>& ids) {
  GraphDocument document;
  std::unordered_map<NodeIndex, VariableId> id_of_node;
  for (std::size_t place = 0; place < ids.size(); ++place) {
    const NodeIndex node = content.order.nodes[place];
    id_of_node.emplace(node, ids[place]);
    const bool added = add_variable(document.graph, ids[place], content.map.nodes[node].type,
                                    content.values[place])
                           .ok();
    CAIRN_CHECK(added, "a node of the map that a graph refuses");
  }
  for (const std::uint32_t f : content.order.factors) {
    const StoredFactor& stored = content.map.factors[f];
    NewFactor factor{
        .type = stored.type, .kind = stored.kind, .nodes = {}, .numbers = stored.numbers};
    std::vector<VariableId> ends;
    for (const NodeIndex node : stored.nodes) ends.push_back(id_of_node.at(node));
    const bool added = add_factor(document.graph, factor, ends).ok();
    CAIRN_CHECK(added, "a factor of the map that a graph refuses");
  }
  document.has_start.assign(ids.size(), true);
  return document;
}

}  // namespace

Result<ExportContent> collect_export(const Question& question, const Asked& asked) {
  Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  if (map->nodes.size() == 0)
    return Error{ErrorCode::kNotUsable, "the map is empty: there is nothing to export yet"};
  ExportContent content{std::move(*map), CanonicalOrder(PoseGraph()), {}};
  if (question.flag("live")) {
    content.order = CanonicalOrder(
        content.map, [&](std::uint32_t f) { return takes_part(content.map.factors[f].state); });
    for (const NodeIndex node : content.order.nodes) {
      const auto* numbers = content.map.estimates[node].data();
      content.values.emplace_back(numbers, numbers + value_numbers(content.map.nodes[node].type));
    }
    return content;
  }
  SettledEstimate settled = settle(content.map, {.keep_going = asked.keep_going});
  if (!settled.summary.usable())
    return Error{ErrorCode::kNotUsable, unsettled_text(settled.summary)};
  content.order = std::move(settled.order);
  for (VariableSlot slot = 0; slot < content.order.nodes.size(); ++slot)
    content.values.push_back(describe_value(settled.graph, slot));
  return content;
}

std::vector<VariableId> choose_export_ids(const ExportContent& content) {
  std::unordered_map<std::uint64_t, int> uses;
  const auto node_at = [&](std::size_t place) -> const NodeId& {
    return content.node_at(place).id;
  };
  const std::size_t count = content.order.nodes.size();
  for (std::size_t place = 0; place < count; ++place) {
    if (is_from_file(node_at(place))) ++uses[node_at(place).index];
  }
  const auto keeps_its_id = [&](const NodeId& node) {
    return is_from_file(node) && uses.at(node.index) == 1;
  };
  std::unordered_set<std::uint64_t> taken;
  for (std::size_t place = 0; place < count; ++place) {
    if (keeps_its_id(node_at(place))) taken.insert(node_at(place).index);
  }
  std::vector<VariableId> ids;
  std::uint64_t next = 0;
  for (std::size_t place = 0; place < count; ++place) {
    if (keeps_its_id(node_at(place))) {
      ids.push_back({node_at(place).index});
      continue;
    }
    while (taken.contains(next)) ++next;
    ids.push_back({next++});
  }
  return ids;
}

Result<std::string> export_graph_text(const ExportContent& content,
                                      const std::vector<VariableId>& ids) {
  const Result<std::string> graph = write_graph_text(to_document(content, ids), GraphFormat::kG2o);
  if (!graph) return graph.error();
  const auto& datum = content.map.datum;
  return (datum ? "# east-north-up at " + to_string(*datum) + '\n' : "") + *graph;
}

Error no_such_robot(const std::string& wanted, const std::string& known) {
  return {ErrorCode::kUsage, "there is no robot '" + wanted + "' with poses; there are: " + known};
}

}  // namespace cairn
