// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cairn::cli {

/// Exit codes of every verb (DESIGN: fixed for scripts).
enum ExitCode : int {
  kDone = 0,
  kInternalError = 1,
  kUsageError = 2,
  kBadInput = 3,
  kNotUsable = 4,
  kUnreachable = 5,
};

/// A verb adds itself as a subcommand with its options and returns what runs when it is chosen.
/// The returned function gives the exit code.
using Run = std::function<int()>;
using AddVerb = Run (*)(CLI::App& parent, CLI::App*& verb);

Run add_optimize(CLI::App& parent, CLI::App*& verb);
Run add_check(CLI::App& parent, CLI::App*& verb);
Run add_info(CLI::App& parent, CLI::App*& verb);
Run add_convert(CLI::App& parent, CLI::App*& verb);
Run add_plot(CLI::App& parent, CLI::App*& verb);
Run add_simulate(CLI::App& parent, CLI::App*& verb);
Run add_eval(CLI::App& parent, CLI::App*& verb);
Run add_replay(CLI::App& parent, CLI::App*& verb);
Run add_verify(CLI::App& parent, CLI::App*& verb);
Run add_status(CLI::App& parent, CLI::App*& verb);
Run add_log(CLI::App& parent, CLI::App*& verb);
Run add_show(CLI::App& parent, CLI::App*& verb);
Run add_diff(CLI::App& parent, CLI::App*& verb);
Run add_explain(CLI::App& parent, CLI::App*& verb);
Run add_edge(CLI::App& parent, CLI::App*& verb);
Run add_undo(CLI::App& parent, CLI::App*& verb);
Run add_revoke(CLI::App& parent, CLI::App*& verb);
Run add_freeze(CLI::App& parent, CLI::App*& verb);
Run add_thaw(CLI::App& parent, CLI::App*& verb);
Run add_settle(CLI::App& parent, CLI::App*& verb);
Run add_backup(CLI::App& parent, CLI::App*& verb);
Run add_restore(CLI::App& parent, CLI::App*& verb);
Run add_map(CLI::App& parent, CLI::App*& verb);
Run add_export(CLI::App& parent, CLI::App*& verb);

}  // namespace cairn::cli
