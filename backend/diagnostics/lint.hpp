// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/diagnostics/finding.hpp"
#include "cairn/diagnostics/repairs.hpp"
#include "cairn/io/graph_file.hpp"

namespace cairn {

struct LintOptions {
  std::optional<GraphFormat> format{};  ///< otherwise recognized by content
  bool strict = false;                  ///< warnings become errors
  std::size_t limit_per_code = 10;      ///< findings kept of each code; all are counted
  bool solve = true;                    ///< solve a copy to judge the scale of the information
};

struct LintReport {
  std::optional<GraphFormat> format;  ///< nothing where it was not recognized
  std::vector<Finding> findings;      ///< in the order of lines, at most the limit of each code
  std::map<CheckCode, std::size_t> counts{};  ///< of every code that occurs
  std::size_t errors = 0, warnings = 0, notes = 0;

  [[nodiscard]] bool clean() const { return errors == 0; }
};

/// Looks for everything in a g2o, TORO or iSAM text that the readers refuse or a user would want to
/// know. Goes on after errors. Memory grows with the text only. `name` stands for the file in
/// messages.
LintReport lint_graph_text(std::string_view text, const std::string& name,
                           const LintOptions& options = {});

/// What --fix makes of a text.
struct RepairedText {
  std::string text;
  std::vector<Change> changes{};  ///< in the order they were made; lines count in the given text
  LintReport before{};            ///< of the given text
  LintReport after{};             ///< of the repaired one: what could not be repaired
};

/// Repairs what can be repaired without guessing. Dropped lines stay as comments, so lines keep
/// their numbers.
RepairedText repair_graph_text(std::string_view text, const std::string& name,
                               const LintOptions& options = {});

}  // namespace cairn
