// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "cairn/diagnostics/finding.hpp"

namespace cairn {

/// One thing `--fix` did.
struct Change {
  CheckCode code;
  std::size_t line = 0;  ///< 0: added at the end of the file
  std::string what;      ///< "normalized the quaternion"
};

/// Edits of a text, collected during one pass over it. One change per line and pass: the next pass
/// sees the outcome.
class Repairs {
 public:
  explicit Repairs(std::string_view text) : text_(text) {}

  /// True when the line may still be changed in this pass.
  [[nodiscard]] bool open(std::size_t line) const { return !lines_.contains(line); }

  /// Replaces parts of one line; each part is a view into the text.
  struct Replacement {
    std::string_view part;
    std::string text;
  };
  void replace(CheckCode code, std::size_t line, const std::vector<Replacement>& parts,
               std::string what);
  /// Makes a comment of the line, so that nothing is lost and line numbers stay.
  void drop(CheckCode code, std::size_t line, std::string_view line_text, std::string what);
  /// Adds a line at the end.
  void append(CheckCode code, std::string line_text, std::string what);

  [[nodiscard]] const std::vector<Change>& changes() const { return changes_; }
  /// The text with every change made.
  [[nodiscard]] std::string apply() const;

 private:
  struct Edit {
    std::size_t offset;
    std::size_t length;
    std::string text;
  };
  std::string_view text_;
  std::vector<Edit> edits_;
  std::vector<std::string> appended_;
  std::vector<Change> changes_;
  std::unordered_set<std::size_t> lines_;
};

}  // namespace cairn
