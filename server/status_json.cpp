// SPDX-License-Identifier: BSD-3-Clause
#include "server/status_json.hpp"

#include "cairn/history/record_json.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStates[] = {"starting", "serving", "refilling", "stopping"};

constexpr std::size_t kNewestShown = 5;  // of what is quarantined

Json or_null(bool known, Json value) { return known ? std::move(value) : Json(); }

Json to_json(const SourceStatus& source, bool is_folder) {
  Json json{{"source", source.source}, {"epoch", source.epoch}};
  json["alive"] = or_null(!is_folder, source.alive);
  json["highest_decided"] = source.highest_decided;
  json["accepted"] = source.accepted;
  json["refused"] = source.refused;
  json["held"] = or_null(!is_folder, source.held);
  json["clock_offset_ns"] = or_null(!is_folder && source.alive, source.clock_offset_ns);
  json["last_refusal"] = source.last_refusal;
  return json;
}

Json to_json(const PoseGraph& map, const StoredFactor& factor, const VerdictRecord& verdict) {
  Json json{{"factor", std::to_string(factor.record) + ':' + std::to_string(factor.name.index)},
            {"source", factor.name.transaction.source},
            {"nodes", Json::array()},
            {"test", verdict.test},
            {"value", verdict.value},
            {"limit", verdict.threshold}};
  for (const NodeIndex node : factor.nodes) json["nodes"].push_back(to_string(map.nodes[node].id));
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const Status& status, bool is_folder) {
  Json json{{"schema_version", 1}};
  json["daemon"] = or_null(!is_folder, {{"version", status.version},
                                        {"host", status.host},
                                        {"state", kStates[static_cast<int>(status.state)]},
                                        {"started", to_utc(status.started_ns)}});
  json["head"] = to_string(status.head);
  json["estimate_revision"] = status.estimate.graph.number;
  json["solved_revision"] = status.estimate.solved.number;
  json["chi2"] = or_null(!is_folder && status.estimate.solved.number > 0, status.chi2);
  json["variables"] = status.variables;
  json["factors"] = status.factors;
  json["datum"] = status.datum ? Json{status.datum->latitude_deg, status.datum->longitude_deg,
                                      status.datum->height_m}
                               : Json();
  json["memory_bytes"] = or_null(!is_folder, status.memory_bytes);
  json["disk_free_bytes"] = status.disk_free_bytes;
  json["message"] = status.message;
  json["sources"] = Json::array();
  for (const SourceStatus& source : status.sources)
    json["sources"].push_back(to_json(source, is_folder));
  return json;
}

void add_judgement(nlohmann::ordered_json& status, const MapHead& head,
                   const std::map<FactorName, VerdictRecord>& why,
                   const std::vector<SourceTrust>& trust) {
  std::size_t count = 0;
  for (Json& source : status["sources"]) {
    const auto own = head.quarantined().find(source["source"].get<std::string>());
    source["quarantined"] = own == head.quarantined().end() ? 0 : own->second;
  }
  for (const auto& [source, own] : head.quarantined()) count += own;
  std::map<std::size_t, const VerdictRecord*> places;  // the newest factors last
  const PoseGraph& map = head.graph();
  for (const auto& [name, verdict] : why)
    if (const auto place = head.find(name);
        place && map.factors[*place].state == FactorState::kQuarantined)
      places.emplace(*place, &verdict);
  status["quarantine"] = {{"count", count}, {"newest", Json::array()}};
  for (auto at = places.rbegin(); at != places.rend(); ++at) {
    Json& newest = status["quarantine"]["newest"];
    if (newest.size() == kNewestShown) break;
    newest.push_back(to_json(map, map.factors[at->first], *at->second));
  }
  status["trust"] = Json::array();
  for (const SourceTrust& row : trust)
    status["trust"].push_back({{"source", row.source},
                               {"robot", row.robot},
                               {"kind", to_string(row.kind)},
                               {"factors", row.factors},
                               {"redundancy", row.redundancy},
                               {"sigma_factor", row.sigma_factor},
                               {"words", describe(row)}});
}

}  // namespace cairn
