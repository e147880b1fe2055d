// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/lint.hpp"

#include "cairn/diagnostics/graph_checks.hpp"
#include "cairn/diagnostics/structure_checks.hpp"
#include "cairn/diagnostics/value_checks.hpp"

namespace cairn {
namespace {

// A byte of zero in the first bytes, or one of the marks of UTF-16: whatever it is, it is not a
// graph in text form.
bool looks_binary(std::string_view text) {
  constexpr std::size_t kLooked = 65536;
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
         text.substr(0, kLooked).find('\0') != std::string_view::npos;
}

std::optional<GraphFormat> find_format(std::string_view text, const std::string& name,
                                       const LintOptions& options, Findings& findings) {
  if (looks_binary(text)) {
    findings.add(CheckCode::kUnreadable, 1, 1,
                 "the file holds binary data or UTF-16, expected plain text (ASCII or UTF-8)",
                 "save it as plain text; .gz and .bz2 files are read as they are");
    return std::nullopt;
  }
  if (options.format) return options.format;
  const auto format = recognize_graph_format(text, name);
  if (format) return *format;
  findings.add(CheckCode::kFormatUnclear, 1, 1, format.error().message,
               "name the format with --format g2o, toro or isam");
  return std::nullopt;
}

LintReport make_report(const Findings& findings, std::optional<GraphFormat> format, bool strict) {
  LintReport report{.format = format, .findings = findings.sorted()};
  for (const CheckCode code : all_check_codes()) {
    if (findings.count(code) > 0) report.counts[code] = findings.count(code);
  }
  report.errors = findings.count(FindingSeverity::kError);
  report.warnings = findings.count(FindingSeverity::kWarning);
  report.notes = findings.count(FindingSeverity::kNote);
  if (!strict) return report;
  report.errors += report.warnings;
  report.warnings = 0;
  for (Finding& finding : report.findings) {
    if (finding.severity == FindingSeverity::kWarning) finding.severity = FindingSeverity::kError;
  }
  return report;
}

LintReport lint(std::string_view text, const std::string& name, const LintOptions& options,
                Repairs& repairs) {
  Findings findings(options.limit_per_code);
  const auto format = find_format(text, name, options, findings);
  if (!format) return make_report(findings, format, options.strict);
  RawGraph graph = scan_raw_graph(text, *format, findings, repairs);
  check_values(graph, findings, repairs);
  const RawStructure structure = check_structure(graph, findings, repairs);
  check_graph(graph, structure, name, options.solve, findings, repairs);
  return make_report(findings, format, options.strict);
}

}  // namespace

LintReport lint_graph_text(std::string_view text, const std::string& name,
                           const LintOptions& options) {
  Repairs repairs(text);
  return lint(text, name, options, repairs);
}

RepairedText repair_graph_text(std::string_view text, const std::string& name,
                               const LintOptions& options) {
  RepairedText result{.text = std::string(text)};
  constexpr int kMostPasses = 8;  // one change per line and pass; what is left then is reported
  LintOptions pass_options = options;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    Repairs repairs(result.text);
    pass_options.solve = options.solve && pass == 0;
    LintReport report = lint(result.text, name, pass_options, repairs);
    if (pass == 0) result.before = report;
    if (repairs.changes().empty()) break;
    result.changes.insert(result.changes.end(), repairs.changes().begin(), repairs.changes().end());
    result.text = repairs.apply();
  }
  result.after = lint_graph_text(result.text, name, options);
  return result;
}

}  // namespace cairn
