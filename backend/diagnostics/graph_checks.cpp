// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/graph_checks.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/diagnostics/components.hpp"
#include "cairn/diagnostics/determination.hpp"
#include "cairn/diagnostics/information_scale.hpp"
#include "cairn/diagnostics/line_repairs.hpp"
#include "cairn/diagnostics/sound_text.hpp"
#include "cairn/diagnostics/vertex_lines.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/solver/marginals.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

std::string plural(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

// "name:line:column" as the readers write it; zeros where it is not there.
std::pair<std::size_t, std::size_t> line_and_column(const std::string& place,
                                                    const std::string& name) {
  std::size_t line = 0, column = 0;
  if (place.size() > name.size() && place.compare(0, name.size(), name) == 0) {
    std::sscanf(place.c_str() + name.size(), ":%zu:%zu", &line, &column);
  }
  return {line, column};
}

class Checker {
 public:
  Checker(const Graph& graph, const RawStructure& structure, Findings& findings)
      : graph_(graph),
        structure_(structure),
        findings_(findings),
        components_(connected_components(graph)) {}

  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

  void check_components() {
    constexpr std::size_t kNamed = 10;
    std::vector<const Component*> parts;
    for (const Component& component : components_) {
      if (component.factors > 0) parts.push_back(&component);
    }
    if (parts.size() < 2) return;
    std::string names;
    for (std::size_t p = 0; p < std::min(parts.size(), kNamed); ++p) {
      names += (p ? ", " : "") + std::to_string(parts[p]->smallest.value) + " (" +
               plural(parts[p]->variables, "variable") + ")";
    }
    if (parts.size() > kNamed) names += ", ...";
    findings_.add(
        CheckCode::kComponents, line_of(parts[1]->smallest), 1,
        "the graph falls into " + std::to_string(parts.size()) +
            " parts that no measurement connects, here by their smallest ids: " + names,
        "each is solved in a frame of its own; add the edges that connect them, or split the file");
  }

  void check_gauge() {
    std::string held;
    std::size_t free_parts = 0;
    constexpr std::size_t kNamed = 5;
    for (const Component& component : components_) {
      if (!component.needs_gauge() || !component.smallest_pose) continue;
      if (free_parts++ < kNamed)
        held += (held.empty() ? "" : ", ") + std::to_string(component.smallest_pose->value);
    }
    if (free_parts > kNamed) held += ", ...";
    if (free_parts > 0) {
      findings_.add(
          CheckCode::kNothingFixed, 0, 0,
          "nothing is fixed" +
              std::string(free_parts > 1 ? " in " + std::to_string(free_parts) + " parts" : "") +
              " and no measurement is absolute: the solver holds pose " + held + " where it starts",
          "add a FIX line to choose the pose yourself");
    }
    for (const Component& component : components_) {
      if (component.fixed.size() < 2) continue;
      findings_.add(CheckCode::kSeveralFixed, line_of(component.fixed[1]), 1,
                    std::to_string(component.fixed.size()) + " vertices of one part are fixed (" +
                        std::to_string(component.fixed[0].value) + ", " +
                        std::to_string(component.fixed[1].value) +
                        (component.fixed.size() > 2 ? ", ..." : "") +
                        "): their given places are taken as exact",
                    "nothing to do if they were surveyed; one is enough to hold the graph");
    }
  }

  void check_fixed_edges() {
    std::size_t count = 0;
    std::string first;
    VariableId where{};
    for (const FactorRef factor : graph_.factors()) {
      const auto slots = graph_.slots_of(factor);
      const bool all_fixed = std::all_of(
          slots.begin(), slots.end(), [&](VariableSlot s) { return graph_.variables()[s].fixed; });
      if (!all_fixed || count++ > 0) continue;
      where = graph_.variables()[slots.back()].id;
      for (const VariableSlot slot : slots)
        first += (first.empty() ? "" : " and ") + std::to_string(graph_.variables()[slot].id.value);
    }
    if (count == 0) return;
    findings_.add(CheckCode::kEdgeBetweenFixed, line_of(where), 1,
                  plural(count, "edge") + (count == 1 ? " touches" : " touch") +
                      " fixed vertices only (first: " + first + "), and cannot change anything",
                  "nothing to do, or fix fewer vertices");
  }

  void check_determination() {
    for (const UndeterminedVariable& variable : find_undetermined_variables(graph_)) {
      const Variable& named = graph_.variables()[variable.slot];
      const std::string who = "vertex " + std::to_string(named.id.value) + " (" +
                              std::string(to_string(named.type)) + ")";
      if (variable.factors == 0) {
        findings_.add(CheckCode::kUnconnected, line_of(named.id), 1,
                      who + " is measured by no edge, and keeps the place it has",
                      "delete its line, or add the edges that are missing");
        continue;
      }
      findings_.add(
          CheckCode::kUndetermined, line_of(named.id), 1,
          who + " is not determined by its " + plural(variable.factors, "measurement") + ": " +
              plural(static_cast<std::size_t>(variable.free_directions.cols()), "direction") +
              " free, " + directions(variable),
          "a landmark needs bearings from two places, or a distance; the solver leaves the vertex "
          "where it is");
    }
  }

 private:
  [[nodiscard]] std::size_t line_of(VariableId id) const { return structure_.line_of(id.value); }

  [[nodiscard]] static std::string directions(const UndeterminedVariable& variable) {
    std::string text;
    for (Eigen::Index c = 0; c < variable.free_directions.cols(); ++c) {
      text += c ? " and (" : "(";
      for (Eigen::Index r = 0; r < variable.free_directions.rows(); ++r) {
        const double part = variable.free_directions(r, c);
        text += (r ? " " : "") + readable(std::abs(part) < 1e-6 ? 0.0 : part);
      }
      text += ')';
    }
    return text;
  }

  const Graph& graph_;
  const RawStructure& structure_;
  Findings& findings_;
  std::vector<Component> components_;
};

std::string name_group(const InformationScale& scale) {
  const char* kind = scale.kind == FactorKind::kOdometry ? " odometry"
                     : scale.kind == FactorKind::kLoop   ? " loop closure"
                                                         : "";
  return std::to_string(scale.factors) + kind + " factors of type " + std::string(scale.type);
}

void report_scales(const Graph& solved, const Marginals* marginals, Findings& findings) {
  constexpr double kFar = 100.0;  // ten times off in standard deviations
  for (const InformationScale& scale : estimate_information_scales(solved, marginals)) {
    if (scale.ratio < kFar && scale.ratio > 1.0 / kFar) continue;
    const bool too_large = scale.ratio > 1.0;
    const double times = too_large ? scale.ratio : 1.0 / scale.ratio;
    findings.add(CheckCode::kInformationScale, 0, 0,
                 "the information of " + name_group(scale) + " is about " + readable(times) +
                     " times too " + (too_large ? "large" : "small") +
                     " for their residuals: the median chi2 per degree of freedom is " +
                     readable(scale.ratio) + ", expected about 1",
                 "multiply it by " + readable(1.0 / scale.ratio) + " (standard deviations by " +
                     readable(std::sqrt(scale.ratio)) + ")" +
                     (too_large ? ", unless many of these measurements are wrong"
                                : "; covariances and robust losses depend on it"));
  }
}

void check_scale(const Graph& graph, Findings& findings) {
  constexpr std::size_t kLargest = 100000, kLargestForMarginals = 20000;
  const std::string skipped = "whether the information fits the residuals was not judged: ";
  if (findings.count(FindingSeverity::kError) > 0) {
    findings.add(CheckCode::kNotAnalyzed, 0, 0, skipped + "the file has errors",
                 "repair them first");
    return;
  }
  if (graph.variables().size() > kLargest) {
    findings.add(CheckCode::kNotAnalyzed, 0, 0,
                 skipped + "the graph has more than " + std::to_string(kLargest) + " variables",
                 "compare chi2 with the degrees of freedom that cairn optimize --json reports");
    return;
  }
  Graph solved = graph;
  classify_factor_kinds(solved);
  const SolveSummary summary = optimize(solved, {.init = InitMethod::kAuto, .max_iterations = 100});
  if (!summary.usable()) {
    findings.add(
        CheckCode::kNotAnalyzed, 0, 0,
        skipped + "the solver stopped early (" + std::string(to_string(summary.stop_reason)) + ")",
        "see cairn optimize");
    return;
  }
  if (graph.variables().size() > kLargestForMarginals || !summary.under_constrained.empty())
    return report_scales(solved, nullptr, findings);
  const auto marginals = Marginals::compute(solved);
  report_scales(solved, marginals ? &*marginals : nullptr, findings);
}

// The reader stops at the first line it refuses: that line is reported and left out, and it reads
// again.
Result<GraphDocument> read_sound_lines(RawGraph& raw, const RawStructure& structure,
                                       const std::string& name, Findings& findings) {
  constexpr int kMostRefusals = 10;
  for (int refusals = 0;; ++refusals) {
    auto document = read_graph_text(sound_text(raw, structure), name, {.format = raw.format});
    if (document) return document;
    const auto [line, column] = line_and_column(document.error().place, name);
    findings.add(CheckCode::kRefused, line, column, document.error().message,
                 "cairn optimize stops here");
    const auto at = static_cast<std::uint32_t>(line);
    const auto refused =
        std::find_if(raw.lines.begin(), raw.lines.end(),
                     [&](const RawLine& candidate) { return candidate.line == at; });
    if (refused == raw.lines.end() || refused->unusable || refusals == kMostRefusals)
      return document;
    refused->broken = refused->unusable = true;
  }
}

}  // namespace

void check_graph(RawGraph& raw, const RawStructure& structure, const std::string& name, bool solve,
                 Findings& findings, Repairs& repairs) {
  const auto document = read_sound_lines(raw, structure, name, findings);
  if (!document) {
    findings.add(CheckCode::kNotAnalyzed, 0, 0,
                 "the graph as a whole was not looked at: its lines must be read first",
                 "repair the errors above");
    return;
  }
  // These repairs look at the graph as a whole, so they wait until the lines are in order.
  const bool lines_in_order = repairs.changes().empty();
  if (lines_in_order) repair_missing_vertices(raw, structure, document->graph, repairs);
  const Graph& graph = document->graph;
  if (graph.factor_count() == 0) {
    findings.add(CheckCode::kNotAnalyzed, 0, 0,
                 "the file has no edges: there is nothing to optimize", "");
    return;
  }
  Checker checker(graph, structure, findings);
  checker.check_components();
  checker.check_gauge();
  checker.check_fixed_edges();
  checker.check_determination();
  if (lines_in_order) repair_gauge(raw, checker.components(), repairs);
  if (solve) check_scale(graph, findings);
}

}  // namespace cairn
