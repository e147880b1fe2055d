// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/io/graph_tags.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/graph_facts.hpp"
#include "clients/cli/graph_format.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct InfoArguments {
  std::vector<std::string> inputs;
  FormatChoice format;
  bool json = false, strict = false;
};

std::string text_of(const char* format, double a, double b, double c) {
  char text[128];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

void print_fact(const char* label, const std::string& value) {
  std::printf("%-22s %s\n", label, value.c_str());
}

void print_counts(const char* label, const std::map<std::string, std::size_t>& counts) {
  for (const auto& [type, count] : counts) {
    print_fact(label, std::to_string(count) + " " + type);
    label = "";
  }
}

void print_text(const GraphDocument& document, const GraphFacts& facts) {
  print_fact("format", std::string(to_string(document.format)));
  print_counts("vertices", facts.variables);
  if (facts.without_start > 0)
    print_fact("", std::to_string(facts.without_start) + " of them without a start value");
  if (facts.fixed > 0) print_fact("", std::to_string(facts.fixed) + " of them held fixed");
  print_counts("edges", facts.factors);
  print_fact("odometry, loops",
             std::to_string(facts.odometry) + ", " + std::to_string(facts.loops));
  print_fact("components", std::to_string(facts.components) + ", " +
                               std::to_string(facts.components_without_gauge) +
                               " of them held by the smallest pose id");
  print_fact("degrees of freedom", std::to_string(facts.degrees_of_freedom));
  print_fact("x, y, z from",
             text_of("%.3f, %.3f, %.3f m", facts.lowest.x(), facts.lowest.y(), facts.lowest.z()));
  print_fact("x, y, z to", text_of("%.3f, %.3f, %.3f m", facts.highest.x(), facts.highest.y(),
                                   facts.highest.z()));
  print_fact("path", text_of("%.3f m", facts.path_m, 0.0, 0.0));
  print_fact("chi2 as read",
             facts.chi2 ? text_of("%.10g", *facts.chi2, 0.0, 0.0) : "none: no vertices");
  if (!document.unknown_lines.empty()) {
    print_fact("unknown lines", std::to_string(document.unknown_lines.size()));
  }
}

nlohmann::ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json corner(const Eigen::Vector3d& p) {
  return {finite_or_null(p.x()), finite_or_null(p.y()), finite_or_null(p.z())};
}

void print_json(const InfoArguments& a, const GraphDocument& document, const GraphFacts& facts) {
  nlohmann::ordered_json json;
  json["schema_version"] = 1;
  json["input"] = a.inputs;
  json["format"] = to_string(document.format);
  json["vertices"] = document.graph.variables().size();
  json["vertices_by_type"] = facts.variables;
  json["vertices_without_start"] = facts.without_start;
  json["fixed"] = facts.fixed;
  json["edges"] = document.graph.factor_count();
  json["edges_by_type"] = facts.factors;
  json["odometry_edges"] = facts.odometry;
  json["loop_edges"] = facts.loops;
  json["components"] = facts.components;
  json["components_without_gauge"] = facts.components_without_gauge;
  json["dof"] = facts.degrees_of_freedom;
  json["bounding_box_m"] = {{"lowest", corner(facts.lowest)}, {"highest", corner(facts.highest)}};
  json["path_m"] = finite_or_null(facts.path_m);
  json["input_chi2"] = facts.chi2 ? finite_or_null(*facts.chi2) : nlohmann::ordered_json();
  json["unknown_lines"] = document.unknown_lines.size();
  json["warnings"] = document.warnings;
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int run_info(const InfoArguments& a) {
  const auto document = read_graphs(a.inputs, {.format = a.format, .strict = a.strict});
  if (!document) return fail(document.error());
  for (const std::string& warning : document->warnings) Console::warn("warning: " + warning);
  const GraphFacts facts = collect_facts(*document);
  a.json ? print_json(a, *document, facts) : print_text(*document, facts);
  return kDone;
}

}  // namespace

Run add_info(CLI::App& parent, CLI::App*& verb) {
  auto arguments = std::make_shared<InfoArguments>();
  verb = parent.add_subcommand("info", "Tell what a graph holds");
  verb->footer(
      "chi2 is in g2o's error chart, as the file's values give it.\n"
      "Exit codes: 0 done, 2 usage, 3 bad input, 1 internal error.");
  verb->add_option("IN", arguments->inputs,
                   "graph files, or a folder in the dlr layout; several are merged by id")
      ->required()
      ->default_str("")
      ->type_name("FILE");
  add_choice(*verb, "--format", arguments->format, graph_formats(),
             "format of the input, where its content does not tell");
  verb->add_flag("--json", arguments->json, "print JSON");
  verb->add_flag("--strict", arguments->strict, "warnings (unknown tags, ...) are errors");
  return [arguments] { return run_info(*arguments); };
}

}  // namespace cairn::cli
