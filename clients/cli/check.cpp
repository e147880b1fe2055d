// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/diagnostics/lint.hpp"
#include "cairn/io/compression.hpp"
#include "cairn/io/graph_tags.hpp"
#include "cairn/io/input_text.hpp"
#include "clients/cli/graph_format.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct CheckOptions {
  std::string input;
  FormatChoice format;
  std::string fix;
  std::string json;
  bool strict = false;
  std::size_t limit = 10;
};

std::string count_of(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void print_finding(std::ostream& out, const std::string& name, const Finding& finding) {
  out << name;
  if (finding.line > 0) out << ':' << finding.line << ':' << finding.column;
  out << ": " << to_string(finding.severity) << ": " << finding.message << " ["
      << to_string(finding.code) << "]\n";
  if (!finding.hint.empty()) out << "    hint: " << finding.hint << '\n';
}

void print_report(std::ostream& out, const std::string& name, const LintReport& report,
                  std::size_t limit) {
  for (const Finding& finding : report.findings) print_finding(out, name, finding);
  for (const auto& [code, count] : report.counts) {
    if (count > limit)
      out << name << ": " << count - limit << " more of " << to_string(code) << " ("
          << title_of(code) << "); --limit shows more\n";
  }
  out << name << ": " << count_of(report.errors, "error") << ", "
      << count_of(report.warnings, "warning") << ", " << count_of(report.notes, "note") << '\n';
}

void print_changes(std::ostream& out, const std::string& name, const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    out << name;
    if (change.line > 0) out << ':' << change.line;
    out << ": fixed: " << change.what << " [" << to_string(change.code) << "]\n";
  }
}

nlohmann::json report_json(const LintReport& report) {
  nlohmann::json findings = nlohmann::json::array();
  for (const Finding& finding : report.findings) {
    findings.push_back({{"code", to_string(finding.code)},
                        {"severity", to_string(finding.severity)},
                        {"line", finding.line},
                        {"column", finding.column},
                        {"message", finding.message},
                        {"hint", finding.hint}});
  }
  nlohmann::json counts = nlohmann::json::object();
  for (const auto& [code, count] : report.counts) counts[to_string(code)] = count;
  return {{"errors", report.errors},
          {"warnings", report.warnings},
          {"notes", report.notes},
          {"findings", findings},
          {"counts", counts}};
}

Result<void> write_json(const CheckOptions& options, const std::string& name,
                        const LintReport& report, const RepairedText* repaired) {
  nlohmann::json json = report_json(report);
  json["schema_version"] = 1;
  json["input"] = name;
  json["format"] =
      report.format ? nlohmann::json(std::string(to_string(*report.format))) : nlohmann::json();
  if (repaired) {
    nlohmann::json changes = nlohmann::json::array();
    for (const Change& change : repaired->changes) {
      changes.push_back(
          {{"code", to_string(change.code)}, {"line", change.line}, {"what", change.what}});
    }
    json["changes"] = changes;
    json["after"] = report_json(repaired->after);
  }
  // Text of the file may be no UTF-8; quoting has made it printable, and what is left is replaced.
  return write_file(options.json,
                    json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

Result<void> write_fixed(const CheckOptions& options, const RepairedText& repaired) {
  return write_file(options.fix, compress(repaired.text, compression_for(options.fix)));
}

// The human report goes to standard error where standard output carries data.
std::ostream& report_stream(const CheckOptions& options) {
  return options.fix == "-" || options.json == "-" ? std::cerr : std::cout;
}

int fix_and_report(const CheckOptions& options, const std::string& name, std::string_view text,
                   const LintOptions& lint) {
  const RepairedText repaired = repair_graph_text(text, name, lint);
  std::ostream& out = report_stream(options);
  print_report(out, name, repaired.before, lint.limit_per_code);
  print_changes(out, name, repaired.changes);
  if (!options.json.empty()) {
    if (const auto written = write_json(options, name, repaired.before, &repaired); !written)
      return fail(written.error());
  }
  // Where nothing was understood there is nothing to write.
  if (!repaired.after.format) return kBadInput;
  if (const auto written = write_fixed(options, repaired); !written) return fail(written.error());
  const std::string fixed_name = options.fix == "-" ? "<stdout>" : options.fix;
  out << fixed_name << ": written, " << count_of(repaired.changes.size(), "change")
      << "; what is left:\n";
  print_report(out, fixed_name, repaired.after, lint.limit_per_code);
  return repaired.after.clean() ? kDone : kBadInput;
}

int check(const CheckOptions& options) {
  if (const auto writable = check_outputs({options.fix, options.json}); !writable) {
    return fail(writable.error());
  }
  if (options.input != "-" && std::filesystem::is_directory(options.input)) {
    return fail(
        {ErrorCode::kUsage,
         "check reads one graph file, and this is a folder; cairn convert makes a file of it",
         options.input});
  }
  const auto text = read_input_text(options.input);
  if (!text) return fail(text.error());
  LintOptions lint{.format = options.format,
                   .strict = options.strict,
                   .limit_per_code = options.limit ? options.limit : ~std::size_t{0}};
  const std::string name = input_name(options.input);
  if (!options.fix.empty()) return fix_and_report(options, name, text->view, lint);
  const LintReport report = lint_graph_text(text->view, name, lint);
  print_report(report_stream(options), name, report, lint.limit_per_code);
  if (!options.json.empty()) {
    if (const auto written = write_json(options, name, report, nullptr); !written)
      return fail(written.error());
  }
  return report.clean() ? kDone : kBadInput;
}

}  // namespace

Run add_check(CLI::App& parent, CLI::App*& verb) {
  verb = parent.add_subcommand("check",
                               "find what is wrong with a graph file, line by line, and repair it");
  auto options = std::make_shared<CheckOptions>();
  verb->add_option("IN", options->input,
                   "graph file (g2o, TORO, iSAM; also .gz, .bz2), - for standard input")
      ->required();
  add_choice(*verb, "--format", options->format, graph_formats(),
             "format of IN; otherwise recognized by content");
  verb->add_option("--fix", options->fix,
                   "write a repaired copy here (- for standard output) and judge that")
      ->type_name("OUT");
  verb->add_flag("--strict", options->strict, "warnings are errors");
  verb->add_option("--json", options->json, "write the findings as JSON here")->type_name("FILE");
  verb->add_option("--limit", options->limit, "findings shown of each code, 0 for all")
      ->type_name("N");
  verb->footer(
      "Exit code: 0 clean or warnings only, 3 errors. The codes are explained in "
      "backend/diagnostics/README.md.");
  return [options] { return check(*options); };
}

}  // namespace cairn::cli
