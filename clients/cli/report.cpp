// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/report.hpp"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchemaVersion = 1;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json initialization_json(const SolveSummary& summary) {
  Json candidates = Json::array();
  for (const InitCandidate& candidate : summary.init_candidates) {
    candidates.push_back({{"name", to_string(candidate.method)},
                          {"chi2", candidate.chi2},
                          {"seconds", candidate.seconds}});
  }
  return {{"chosen", to_string(summary.init_chosen)}, {"candidates", candidates}};
}

Json under_constrained_json(const SolveSummary& summary) {
  Json all = Json::array();
  for (const UnderConstrainedVariable& variable : summary.under_constrained) {
    Json directions = Json::array();
    for (const auto& column : variable.free_directions.colwise()) {
      directions.push_back(std::vector<double>(column.begin(), column.end()));
    }
    all.push_back({{"id", variable.id.value}, {"free_directions", directions}});
  }
  return all;
}

Json gate_json(const GateReport& gate) {
  Json left_out = Json::array();
  for (const auto& [from, to, verdict] : gate.left_out) {
    left_out.push_back({{"from", from.value},
                        {"to", to.value},
                        {"edge", verdict.factor},
                        {"test", to_string(verdict.test)},
                        {"value", verdict.value},
                        {"threshold", verdict.threshold}});
  }
  return {{"loops", gate.loops}, {"noise_scale", gate.noise_scale}, {"left_out", left_out}};
}

Json iterations_json(const SolveSummary& summary) {
  Json all = Json::array();
  for (const IterationReport& iteration : summary.iterations) {
    all.push_back({{"chi2", iteration.chi2},
                   {"lambda", iteration.lambda},
                   {"accepted", iteration.accepted},
                   {"linearize_s", iteration.linearize_s},
                   {"factorize_s", iteration.factorize_s},
                   {"solve_s", iteration.solve_s},
                   {"total_s", iteration.total_s}});
  }
  return all;
}

}  // namespace

std::string json_text(const OptimizeReport& report) {
  const SolveSummary& summary = report.summary;
  Json json;
  json["schema_version"] = kSchemaVersion;
  json["input"] = report.inputs;
  json["vertices"] = report.vertices;
  json["edges"] = report.edges;
  json["components"] = summary.components;
  json["dof"] = summary.degrees_of_freedom;
  json["error_chart"] = to_string(report.chart);
  json["input_chi2"] = or_null(report.input_chi2);
  json["initialization"] = initialization_json(summary);
  if (report.gate) json["gate"] = gate_json(*report.gate);
  json["initial_chi2"] = summary.initial_chi2;
  json["final_chi2"] = summary.final_chi2;
  json["final_cost"] = summary.final_cost;
  json["status"] = to_string(summary.status);
  json["stop_reason"] = to_string(summary.stop_reason);
  json["usable"] = summary.usable();
  json["under_constrained"] = under_constrained_json(summary);
  json["iterations"] = iterations_json(summary);
  json["setup_s"] = summary.setup_s;
  json["optimize_s"] = summary.optimize_s;
  json["read_s"] = report.read_s;
  json["write_s"] = or_null(report.write_s);
  json["peak_rss_bytes"] = peak_rss_bytes();
  json["threads"] = summary.threads;
  json["linear"] = to_string(summary.linear);
  json["ordering"] = summary.ordering.empty() ? Json() : Json(summary.ordering);
  json["factor_nnz"] = or_null(summary.factor_nonzeros);
  // File names may hold bytes that are not UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::int64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace cairn::cli
