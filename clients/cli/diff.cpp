// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct DiffArguments {
  Target target;
  std::uint64_t from = 0, to = 0;
  bool json = false;
};

}  // namespace

Run add_diff(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<DiffArguments>();
  verb = parent.add_subcommand("diff", "Tell what happened to the map between two revisions");
  verb->footer(
      "Variables and factors added, factors whose state changed, and how far estimates moved (m, "
      "rad).\n"
      "Exit codes: 0 done, 2 usage or no such revision, 3 damaged, 5 no daemon answers.");
  verb->add_option("R1", a->from, "the older revision; 0: the empty map")
      ->required()
      ->default_str("");
  verb->add_option("R2", a->to, "the newer one")->required()->default_str("");
  add_target(*verb, a->target);
  verb->add_flag("--json", a->json, "print JSON, with all names");
  return [a] {
    return ask_and_print(a->target,
                         {"diff", {{"from", a->from}, {"to", a->to}, {"json", a->json}}});
  };
}

}  // namespace cairn::cli
