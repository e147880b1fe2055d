// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <vector>

#include "clients/cli/verb.hpp"

namespace {

// In the order `cairn --help` lists them.
const std::vector<cairn::cli::AddVerb> kVerbs{
    // one line per verb
};

int run(int argc, char** argv) {
  CLI::App app{"Cairn: a map server for robots. This command works on graph files.", "cairn"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "cairn 0.1.0");
  app.option_defaults()->always_capture_default();
  std::vector<std::pair<CLI::App*, cairn::cli::Run>> verbs;
  for (const cairn::cli::AddVerb add : kVerbs) {
    CLI::App* verb = nullptr;
    cairn::cli::Run verb_run = add(app, verb);
    verbs.emplace_back(verb, std::move(verb_run));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cairn::cli::kDone : cairn::cli::kUsageError;
  }
  for (const auto& [verb, verb_run] : verbs) {
    if (verb->parsed()) return verb_run();
  }
  return cairn::cli::kUsageError;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cairn: internal error: %s\n", error.what());
    return cairn::cli::kInternalError;
  }
}
