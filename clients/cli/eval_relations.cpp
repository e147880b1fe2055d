// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/evaluation/relations.hpp"
#include "cairn/io/input_text.hpp"
#include "cairn/io/time_stamp.hpp"
#include "clients/cli/eval.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct RelationReport {
  const EvalArguments& a;
  Relations reference;
  RelationErrors found;
  Statistics translation_m, rotation_deg;

  [[nodiscard]] std::string place(std::size_t relation) const {
    return reference.name + ":" + std::to_string(reference.relations[relation].line);
  }
  [[nodiscard]] std::string stamps(std::size_t relation) const {
    const auto text = [](std::uint64_t ns) { return format_stamp(static_cast<std::int64_t>(ns)); };
    return text(reference.relations[relation].from_ns) + " " +
           text(reference.relations[relation].to_ns);
  }
  // Places in `found.errors`, the largest translation error first.
  [[nodiscard]] std::vector<std::size_t> worst() const {
    const std::vector<double>& error = found.errors.translation_m;
    std::vector<std::size_t> order(error.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return error[i] > error[j]; });
    order.resize(std::min(order.size(), a.worst));
    return order;
  }
};

Result<RelationReport> evaluate(const EvalArguments& a) {
  Result<Relations> reference = read_relations(a.reference);
  if (!reference) return reference.error();
  const Result<Trajectory> estimate = read_trajectory(a.estimate);
  if (!estimate) return estimate.error();
  Result<RelationErrors> found =
      relation_errors(*reference, *estimate, a.max_difference_ns(kDefaultRelationDifferenceNs));
  if (!found) return found.error();
  const Statistics translation_m = compute_statistics(found->errors.translation_m),
                   rotation_deg = compute_statistics(found->errors.rotation_deg);
  return RelationReport{a, std::move(*reference), std::move(*found), translation_m, rotation_deg};
}

void print(const RelationReport& r) {
  const Console console(r.a.json == "-", r.a.quiet);
  console.say("error of relations: " + std::to_string(r.found.errors.at.size()) + " relations, " +
              std::to_string(r.found.unmatched.size()) + " unmatched");
  print_statistics(console, r.translation_m, r.rotation_deg);
  for (const std::size_t i : r.worst()) {
    const std::size_t relation = r.found.errors.at[i];
    char error[80];
    std::snprintf(error, sizeof error, ": %.4f m, %.3f deg from ", r.found.errors.translation_m[i],
                  r.found.errors.rotation_deg[i]);
    console.say(r.place(relation) + error + r.stamps(relation));
  }
}

std::string json_text(const RelationReport& r) {
  nlohmann::ordered_json json;
  json["metric"] = "relations";
  json["align"] = "none";
  json["pairs"] = r.found.errors.at.size();
  json["unmatched"] = r.found.unmatched.size();
  json["translation"] = json_of(r.translation_m);
  json["rotation"] = json_of(r.rotation_deg);
  if (r.a.worst > 0) json["worst"] = nlohmann::ordered_json::array();
  for (const std::size_t i : r.worst()) {
    const Relation& relation = r.reference.relations[r.found.errors.at[i]];
    json["worst"].push_back({{"line", relation.line},
                             {"from_ns", relation.from_ns},
                             {"to_ns", relation.to_ns},
                             {"translation", r.found.errors.translation_m[i]},
                             {"rotation", r.found.errors.rotation_deg[i]}});
  }
  return json.dump(2) + "\n";
}

// A relation without its poses is not measured: a warning, an error when it is asked for or when
// nothing else is left.
Result<void> judge_unmatched(const RelationReport& r) {
  if (r.found.unmatched.empty()) return {};
  const std::size_t first = r.found.unmatched.front();
  const bool none = r.found.errors.at.empty();
  const std::string message =
      (none ? "no relation has"
            : std::to_string(r.found.unmatched.size()) + " of " +
                  std::to_string(r.reference.relations.size()) + " relations lack") +
      std::string(none ? " both its poses in " : " a pose in ") + input_name(r.a.estimate) +
      (none ? "; do both use the same clock, and are stamps written to the microsecond?"
            : ", the first from " + r.stamps(first));
  if (none || r.a.strict) return Error{ErrorCode::kNotUsable, message, r.place(first)};
  Console::warn(r.place(first) + ": " + message);
  return {};
}

}  // namespace

int run_relations(const EvalArguments& a) {
  const Result<RelationReport> report = evaluate(a);
  if (!report) return fail(report.error());
  if (!a.json.empty()) {
    if (const auto written = write_file(a.json, json_text(*report)); !written)
      return fail(written.error());
  }
  const Result<void> matched = judge_unmatched(*report);
  if (!matched && report->found.errors.at.empty()) return fail(matched.error());
  print(*report);
  return exit_code(matched);
}

}  // namespace cairn::cli
