// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/export.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "cairn/history/export_content.hpp"
#include "cairn/io/time_stamp.hpp"

namespace cairn {
namespace {

// A field of a CSV file, quoted where it must be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string describe_ids(const ExportContent& content, const std::vector<VariableId>& ids) {
  std::string text = "id,robot,epoch,index\n";
  for (std::size_t place = 0; place < ids.size(); ++place) {
    const NodeId& node = content.node_at(place).id;
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
std::string tum_text(const ExportContent& content, std::vector<std::size_t> places) {
  const bool stamped = std::all_of(places.begin(), places.end(), [&](std::size_t place) {
    return content.node_at(place).stamp_ns != 0;
  });
  if (stamped) {
    std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
      return content.node_at(a).stamp_ns < content.node_at(b).stamp_ns;
    });
  }
  std::set<std::uint64_t> epochs;
  for (const std::size_t place : places) epochs.insert(content.node_at(place).id.frame.epoch);
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const StoredNode& node = content.node_at(places[i]);
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
  const Result<ExportContent> content = collect_export(question, asked);
  if (!content) return content.error();
  const std::vector<VariableId> ids = choose_export_ids(*content);
  const Result<std::string> graph = export_graph_text(*content, ids);
  if (!graph) return graph.error();
  return join_files({{"graph", *graph}, {"ids", describe_ids(*content, ids)}});
}

Result<std::string> answer_export_trajectory(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"robot", "live"}); !known) return known.error();
  const Result<ExportContent> content = collect_export(question, asked);
  if (!content) return content.error();
  std::map<std::string, std::vector<std::size_t>> places_of_robot;
  for (std::size_t place = 0; place < content->values.size(); ++place) {
    const StoredNode& node = content->node_at(place);
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
  if (files.empty()) return no_such_robot(wanted, known);
  return join_files(files);
}

}  // namespace cairn
