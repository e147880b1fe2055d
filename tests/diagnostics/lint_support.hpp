// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cairn/diagnostics/lint.hpp"

namespace cairn::test {

/// "line:column CODE" of every finding.
inline std::vector<std::string> places(const LintReport& report) {
  std::vector<std::string> places;
  for (const Finding& finding : report.findings) {
    places.push_back(std::to_string(finding.line) + ":" + std::to_string(finding.column) + " " +
                     to_string(finding.code));
  }
  return places;
}

/// All messages, for failing tests.
inline std::string messages(const LintReport& report) {
  std::string text;
  for (const Finding& finding : report.findings) {
    text += std::to_string(finding.line) + ":" + std::to_string(finding.column) + " " +
            to_string(finding.code) + " " + finding.message + '\n';
  }
  return text;
}

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace cairn::test
