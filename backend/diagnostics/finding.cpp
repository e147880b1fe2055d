// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/finding.hpp"

#include <algorithm>
#include <limits>

#include "cairn/core/check.hpp"

namespace cairn {
namespace {

struct CodeInfo {
  CheckCode code;
  FindingSeverity severity;
  std::string_view title;
};

constexpr FindingSeverity kNote = FindingSeverity::kNote;
constexpr FindingSeverity kWarning = FindingSeverity::kWarning;
constexpr FindingSeverity kError = FindingSeverity::kError;

constexpr CodeInfo kCodes[] = {
    {CheckCode::kUnreadable, kError, "not readable as text"},
    {CheckCode::kFormatUnclear, kError, "format not recognized"},
    {CheckCode::kUnknownTag, kWarning, "unknown tag"},
    {CheckCode::kWrongCount, kError, "wrong number of columns"},
    {CheckCode::kNotANumber, kError, "not a number"},
    {CheckCode::kDecimalComma, kError, "decimal comma"},
    {CheckCode::kNotFinite, kError, "NaN or infinity"},
    {CheckCode::kBadId, kError, "not an id"},
    {CheckCode::kNotATag, kError, "line does not begin with a tag"},
    {CheckCode::kQuaternionZero, kError, "quaternion of length zero"},
    {CheckCode::kQuaternionNotUnit, kWarning, "quaternion not normalized"},
    {CheckCode::kInformationIndefinite, kError, "information not positive semidefinite"},
    {CheckCode::kInformationOrder, kError, "information in the order of another format"},
    {CheckCode::kInformationZero, kWarning, "information is zero"},
    {CheckCode::kInformationSemidefinite, kNote, "information is singular"},
    {CheckCode::kDegrees, kWarning, "angles look like degrees"},
    {CheckCode::kQuaternionOrder, kWarning, "quaternions look like w first"},
    {CheckCode::kInformationOrderPlausible, kWarning,
     "information may be in the order of another format"},
    {CheckCode::kEdgeWithinPose, kWarning, "edge between two ids of one pose"},
    {CheckCode::kVertexRepeated, kError, "vertex written twice, alike"},
    {CheckCode::kVertexRedefined, kError, "vertex defined twice, differently"},
    {CheckCode::kSelfEdge, kError, "edge from a vertex to itself"},
    {CheckCode::kDuplicateEdge, kWarning, "edge written twice, alike"},
    {CheckCode::kDanglingId, kError, "edge to a vertex without a line of its own"},
    {CheckCode::kWrongType, kError, "vertex of another type than the edge needs"},
    {CheckCode::kMissingParameter, kError, "sensor offset not defined"},
    {CheckCode::kFixUnknown, kError, "FIX of a vertex that does not exist"},
    {CheckCode::kParallelEdges, kNote, "several edges between the same vertices"},
    {CheckCode::kEdgeBetweenFixed, kNote, "edge between fixed vertices"},
    {CheckCode::kComponents, kWarning, "graph falls into parts"},
    {CheckCode::kNothingFixed, kNote, "nothing is fixed"},
    {CheckCode::kSeveralFixed, kNote, "several poses are fixed"},
    {CheckCode::kUnconnected, kWarning, "variable without measurements"},
    {CheckCode::kUndetermined, kWarning, "variable not determined by its measurements"},
    {CheckCode::kInformationScale, kWarning, "information does not fit the residuals"},
    {CheckCode::kNoVertices, kNote, "file has edges only"},
    {CheckCode::kOdometryGap, kNote, "no edge between consecutive poses"},
    {CheckCode::kPlanarAndSpatial, kWarning, "2-D and 3-D in one file"},
    {CheckCode::kVerticesLeftOut, kWarning, "a part of the vertices has no lines"},
    {CheckCode::kRefused, kError, "refused by the reader"},
    {CheckCode::kNotAnalyzed, kNote, "part of the analysis left out"},
};

const CodeInfo& info_of(CheckCode code) {
  const auto* found = std::find_if(std::begin(kCodes), std::end(kCodes),
                                   [&](const CodeInfo& info) { return info.code == code; });
  CAIRN_CHECK(found != std::end(kCodes), "check code without an entry");
  return *found;
}

}  // namespace

std::string_view to_string(FindingSeverity severity) {
  constexpr std::string_view kNames[] = {"note", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::string to_string(CheckCode code) {
  const std::string digits = std::to_string(static_cast<int>(code));
  return "CHK" + std::string(3 - digits.size(), '0') + digits;
}

FindingSeverity severity_of(CheckCode code) { return info_of(code).severity; }
std::string_view title_of(CheckCode code) { return info_of(code).title; }

std::vector<CheckCode> all_check_codes() {
  std::vector<CheckCode> codes;
  for (const CodeInfo& info : kCodes) codes.push_back(info.code);
  return codes;
}

bool Findings::full(CheckCode code) const {
  return kept_counts_[static_cast<std::size_t>(code)] >= limit_;
}

void Findings::add(CheckCode code, std::size_t line, std::size_t column, std::string message,
                   std::string hint) {
  count_only(code);
  if (full(code)) return;
  ++kept_counts_[static_cast<std::size_t>(code)];
  kept_.push_back({code, severity_of(code), line, column, std::move(message), std::move(hint)});
}

std::vector<Finding> Findings::sorted() const {
  std::vector<Finding> findings = kept_;
  const auto line_key = [](const Finding& f) {
    return f.line == 0 ? std::numeric_limits<std::size_t>::max() : f.line;
  };
  std::stable_sort(findings.begin(), findings.end(), [&](const Finding& a, const Finding& b) {
    return line_key(a) != line_key(b) ? line_key(a) < line_key(b) : a.column < b.column;
  });
  return findings;
}

std::size_t Findings::count(FindingSeverity severity) const {
  std::size_t sum = 0;
  for (const CodeInfo& info : kCodes) {
    if (info.severity == severity) sum += count(info.code);
  }
  return sum;
}

}  // namespace cairn
