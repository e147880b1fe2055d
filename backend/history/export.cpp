// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/export.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/io/time_stamp.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {
namespace {

// What is written: the order of the nodes, and where each is, by place in that order.
struct Content {
  PoseGraph map;
  CanonicalOrder order;
  std::vector<std::vector<double>> values;
};

Result<Content> collect(const Question& question, const Asked& asked) {
  Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  if (map->nodes.size() == 0)
    return Error{ErrorCode::kNotUsable, "the map is empty: there is nothing to export yet"};
  Content content{std::move(*map), CanonicalOrder(PoseGraph()), {}};
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

bool is_from_file(const NodeId& node) { return node.frame.epoch == 0; }

// By place in the canonical order.
std::vector<VariableId> choose_ids(const Content& content) {
  std::unordered_map<std::uint64_t, int> uses;
  const auto node_at = [&](std::size_t place) -> const NodeId& {
    return content.map.nodes[content.order.nodes[place]].id;
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

GraphDocument to_document(const Content& content, const std::vector<VariableId>& ids) {
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

// A field of a CSV file, quoted where it must be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string describe_ids(const Content& content, const std::vector<VariableId>& ids) {
  std::string text = "id,robot,epoch,index\n";
  for (std::size_t place = 0; place < ids.size(); ++place) {
    const NodeId& node = content.map.nodes[content.order.nodes[place]].id;
    text += std::to_string(ids[place].value) + ',' + field(node.frame.robot) + ',' +
            std::to_string(node.frame.epoch) + ',' + std::to_string(node.index) + '\n';
  }
  return text;
}

// x y z qx qy qz qw, qw >= 0.
std::vector<double> in_space(VariableType type, const std::vector<double>& value) {
  if (type == VariableType::kPose2)
    return {value[0], value[1], 0.0, 0.0, 0.0, std::sin(0.5 * value[2]), std::cos(0.5 * value[2])};
  std::vector<double> pose = value;
  if (pose[6] < 0.0) {
    for (std::size_t i = 3; i < 7; ++i) pose[i] = -pose[i];
  }
  return pose;
}

// Of one robot, by place in the canonical order.
std::string tum_text(const Content& content, std::vector<std::size_t> places) {
  const auto node_at = [&](std::size_t place) -> const StoredNode& {
    return content.map.nodes[content.order.nodes[place]];
  };
  const bool stamped = std::all_of(places.begin(), places.end(),
                                   [&](std::size_t place) { return node_at(place).stamp_ns != 0; });
  if (stamped) {
    std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
      return node_at(a).stamp_ns < node_at(b).stamp_ns;
    });
  }
  std::set<std::uint64_t> epochs;
  for (const std::size_t place : places) epochs.insert(node_at(place).id.frame.epoch);
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const StoredNode& node = node_at(places[i]);
    text += stamped ? format_stamp(node.stamp_ns)
                    : std::to_string(epochs.size() > 1 ? i : node.id.index);
    for (const double number : in_space(node.type, content.values[places[i]])) {
      char digits[40];
      digits[0] = ' ';
      text.append(digits, std::to_chars(digits + 1, digits + sizeof digits, number).ptr);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string join_files(const NamedFiles& files) {
  nlohmann::ordered_json header = nlohmann::ordered_json::array();
  std::string contents;
  for (const auto& [name, content] : files) {
    header.push_back({{"name", name}, {"bytes", content.size()}});
    contents += content;
  }
  return dump(header, -1) + '\n' + contents;
}

Result<NamedFiles> split_files(const std::string& text) {
  const Error no_files{ErrorCode::kInternal,
                       "the answer holds no files; do client and daemon have the same version?"};
  std::size_t at = text.find('\n');
  if (at == std::string::npos) return no_files;
  const auto header = nlohmann::ordered_json::parse(text.substr(0, at++), nullptr, false);
  if (!header.is_array()) return no_files;
  NamedFiles files;
  for (const auto& file : header) {
    const std::size_t bytes = file.value("bytes", std::size_t{0});
    if (bytes > text.size() - at) return no_files;
    files.emplace_back(file.value("name", ""), text.substr(at, bytes));
    at += bytes;
  }
  return files;
}

Result<std::string> answer_export_graph(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"live"}); !known) return known.error();
  const Result<Content> content = collect(question, asked);
  if (!content) return content.error();
  const std::vector<VariableId> ids = choose_ids(*content);
  const Result<std::string> graph = write_graph_text(to_document(*content, ids), GraphFormat::kG2o);
  if (!graph) return graph.error();
  const auto& datum = content->map.datum;
  const std::string place = datum ? "# east-north-up at " + to_string(*datum) + '\n' : "";
  return join_files({{"graph", place + *graph}, {"ids", describe_ids(*content, ids)}});
}

Result<std::string> answer_export_trajectory(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"robot", "live"}); !known) return known.error();
  const Result<Content> content = collect(question, asked);
  if (!content) return content.error();
  std::map<std::string, std::vector<std::size_t>> places_of_robot;
  for (std::size_t place = 0; place < content->values.size(); ++place) {
    const StoredNode& node = content->map.nodes[content->order.nodes[place]];
    if (is_pose(node.type)) places_of_robot[node.id.frame.robot].push_back(place);
  }
  const std::string wanted = question.text("robot");
  NamedFiles files;
  std::string known;
  for (auto& [robot, places] : places_of_robot) {
    known += (known.empty() ? "" : ", ") + robot;
    if (wanted.empty() || wanted == robot)
      files.emplace_back(robot, tum_text(*content, std::move(places)));
  }
  if (files.empty())
    return Error{ErrorCode::kUsage,
                 "there is no robot '" + wanted + "' with poses; there are: " + known};
  return join_files(files);
}

}  // namespace cairn
