// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "clients/cli/verb.hpp"

namespace cairn::cli {

inline constexpr const char* kVersion = "0.1.0";

/// The whole command line: every verb with its options, and what runs the chosen one.
class CommandLine {
 public:
  CommandLine();

  /// Parses and runs. Gives the exit code.
  int run(int argc, const char* const* argv);
  /// For what describes the command line: manual pages and completion.
  [[nodiscard]] const CLI::App& app() const { return *app_; }

 private:
  std::unique_ptr<CLI::App> app_;
  std::vector<std::pair<CLI::App*, Run>> verbs_;
};

/// A verb that --help does not list: writes the manual pages (man1/*.1) and the bash completion
/// into a folder.
Run add_generate_docs(CLI::App& parent, CLI::App*& verb);

}  // namespace cairn::cli
