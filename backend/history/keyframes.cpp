// SPDX-License-Identifier: BSD-3-Clause
// keyframes: poses with what was seen there, for those who look for loops among all robots.
#include <algorithm>
#include <optional>
#include <vector>

#include "cairn/core/base64.hpp"
#include "cairn/history/question.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kBytes = 1u << 20, kMostBytes = 16u << 20;
constexpr std::size_t kMostAgain = 4096;

// Nothing where one of its payloads has not come.
std::optional<Json> describe(const StoredNode& node, std::size_t place, const Journal& journal,
                             std::uint64_t& bytes) {
  Json payloads = Json::array();
  for (const ContentHash& hash : node.payloads) {
    const Result<std::string> payload = journal.read_payload(hash);
    if (!payload) return std::nullopt;
    bytes += payload->size();
    payloads.push_back(to_base64(*payload));
  }
  return Json{
      {"place", place},         {"robot", node.id.frame.robot}, {"epoch", node.id.frame.epoch},
      {"index", node.id.index}, {"stamp_ns", node.stamp_ns},    {"payloads", std::move(payloads)}};
}

// Up to which place a source has tied keyframes to older ones; 0: none.
std::size_t closed_up_to(const PoseGraph& map, const std::string& source) {
  std::size_t end = 0;
  for (std::size_t f = 0; f < map.factors.size(); ++f) {
    const StoredFactor& factor = map.factors[f];
    if (factor.kind != FactorKind::kLoop || factor.name.transaction.source != source) continue;
    for (const NodeIndex node : factor.nodes) end = std::max<std::size_t>(end, node + 1);
  }
  return end;
}

std::vector<std::size_t> places_again(const Question& question) {
  std::vector<std::size_t> places;
  const auto again = question.options.find("again");
  if (again == question.options.end() || !again->is_array()) return places;
  for (const Json& place : *again) {
    if (places.size() == kMostAgain) break;
    if (place.is_number_unsigned()) places.push_back(place.get<std::size_t>());
  }
  return places;
}

}  // namespace

Result<std::string> answer_keyframes(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"from", "again", "most_bytes", "source"}); !known)
    return known.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  const std::uint64_t most = std::min(question.number("most_bytes", kBytes), kMostBytes);
  const std::vector<NodeIndex> counting = nodes_that_count(*map);
  Json keyframes = Json::array(), waiting = Json::array();
  std::uint64_t bytes = 0;
  const auto tell = [&](std::size_t place) {
    if (!std::binary_search(counting.begin(), counting.end(), place)) return;
    const StoredNode& node = map->nodes[place];
    if (!is_pose(node.type) || node.payloads.empty()) return;
    if (auto keyframe = describe(node, place, asked.journal, bytes))
      keyframes.push_back(std::move(*keyframe));
    else
      waiting.push_back(place);
  };
  for (const std::size_t place : places_again(question)) {
    if (bytes < most)
      tell(place);
    else
      waiting.push_back(place);
  }
  std::size_t next = question.number("from", 0);
  for (; next < map->nodes.size() && bytes < most; ++next) tell(next);
  const Revision at = map->graph_revision;
  return dump(Json{{"store", at.store},
                   {"era", at.era},
                   {"next", next},
                   {"places", map->nodes.size()},
                   {"closed", closed_up_to(*map, question.text("source"))},
                   {"keyframes", std::move(keyframes)},
                   {"waiting", std::move(waiting)}},
              -1);
}

}  // namespace cairn
