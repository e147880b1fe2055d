// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/app.hpp"

namespace cairn::cli {
namespace {

// In the order `cairn --help` lists them.
const std::vector<AddVerb> kVerbs{
    add_optimize, add_check,  add_convert, add_info,          add_plot,   add_simulate, add_eval,
    add_replay,   add_status, add_log,     add_show,          add_diff,   add_explain,  add_edge,
    add_undo,     add_revoke, add_freeze,  add_thaw,          add_settle, add_verify,   add_map,
    add_export,   add_backup, add_restore, add_generate_docs,
};

}  // namespace

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>(
          "Cairn: a map server for robots. This command works on graph files, daemons "
          "and their data folders.",
          "cairn")) {
  app_->require_subcommand(1);
  app_->set_version_flag("--version", std::string("cairn ") + kVersion);
  app_->option_defaults()->always_capture_default();
  app_->footer("`cairn VERB --help` lists the options of a verb.");
  for (const AddVerb add : kVerbs) {
    CLI::App* verb = nullptr;
    Run verb_run = add(*app_, verb);
    verbs_.emplace_back(verb, std::move(verb_run));
  }
}

int CommandLine::run(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? kDone : kUsageError;
  }
  for (const auto& [verb, verb_run] : verbs_) {
    if (verb->parsed()) return verb_run();
  }
  return kUsageError;
}

}  // namespace cairn::cli
