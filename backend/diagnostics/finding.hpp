// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

enum class FindingSeverity : std::uint8_t { kNote, kWarning, kError };
std::string_view to_string(FindingSeverity severity);  ///< "note", "warning", "error"

/// What `cairn check` can find. The numbers are stable: scripts may rely on them
/// (backend/diagnostics/README.md).
enum class CheckCode : std::uint16_t {
  // the text
  kUnreadable = 1,
  kFormatUnclear = 2,
  kUnknownTag = 3,
  kWrongCount = 4,
  kNotANumber = 5,
  kDecimalComma = 6,
  kNotFinite = 7,
  kBadId = 8,
  kNotATag = 9,
  // the numbers of one line
  kQuaternionZero = 10,
  kQuaternionNotUnit = 11,
  kInformationIndefinite = 12,
  kInformationOrder = 13,
  kInformationZero = 14,
  kInformationSemidefinite = 15,
  kDegrees = 16,
  kQuaternionOrder = 17,
  kInformationOrderPlausible = 18,
  // lines against each other
  kVertexRepeated = 20,
  kVertexRedefined = 21,
  kSelfEdge = 22,
  kDuplicateEdge = 23,
  kDanglingId = 24,
  kWrongType = 25,
  kMissingParameter = 26,
  kFixUnknown = 27,
  kParallelEdges = 28,
  kEdgeBetweenFixed = 29,
  kEdgeWithinPose = 19,
  // the graph
  kComponents = 30,
  kNothingFixed = 31,
  kSeveralFixed = 32,
  kUnconnected = 33,
  kUndetermined = 34,
  kInformationScale = 35,
  kNoVertices = 36,
  kOdometryGap = 37,
  kPlanarAndSpatial = 38,
  kVerticesLeftOut = 39,
  // the reader
  kRefused = 90,
  kNotAnalyzed = 92,
};

/// "CHK012".
std::string to_string(CheckCode code);
/// The severity a code has without --strict.
FindingSeverity severity_of(CheckCode code);
/// What the code is about, in a few words.
std::string_view title_of(CheckCode code);
/// All codes, in ascending order.
std::vector<CheckCode> all_check_codes();

/// One finding. Line and column count from 1; 0 where the finding is about the whole file.
struct Finding {
  CheckCode code;
  FindingSeverity severity;
  std::size_t line = 0;
  std::size_t column = 0;
  std::string message;  ///< what is there and what was expected
  std::string hint;     ///< what to do about it; may be empty
};

/// Collects findings: keeps the first `limit` of each code and counts the rest, so memory is
/// bounded.
class Findings {
 public:
  explicit Findings(std::size_t limit_per_code) : limit_(limit_per_code) {}

  void add(CheckCode code, std::size_t line, std::size_t column, std::string message,
           std::string hint = {});
  /// Only counts one more: for callers that can tell in advance that it is beyond the limit.
  [[nodiscard]] bool full(CheckCode code) const;
  void count_only(CheckCode code) { ++counts_[static_cast<std::size_t>(code)]; }

  /// In the order of lines, findings about the whole file last.
  [[nodiscard]] std::vector<Finding> sorted() const;
  [[nodiscard]] std::size_t count(CheckCode code) const {
    return counts_[static_cast<std::size_t>(code)];
  }
  [[nodiscard]] std::size_t count(FindingSeverity severity) const;

 private:
  std::size_t limit_;
  std::vector<Finding> kept_;
  std::array<std::size_t, 100> kept_counts_{};
  std::array<std::size_t, 100> counts_{};
};

}  // namespace cairn
