// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace cairn::cli {

/// Where a verb talks to people: standard output, or standard error when an output goes to "-".
class Console {
 public:
  Console(bool output_on_stdout, bool quiet)
      : stream_(output_on_stdout ? stderr : stdout), quiet_(quiet) {}

  /// Prints a line, unless quiet.
  void say(const std::string& line) const;
  /// Prints a line to standard error, quiet or not.
  static void warn(const std::string& line);
  /// Shows `line` in place of the last one shown so; only on a terminal and unless quiet.
  void show_progress(const std::string& line) const;
  void clear_progress() const { show_progress(""); }

 private:
  std::FILE* stream_;
  bool quiet_;
};

}  // namespace cairn::cli
