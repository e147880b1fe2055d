// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct ShowArguments {
  Target target;
  std::uint64_t number = 0;
  bool json = false;
};

}  // namespace

Run add_show(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ShowArguments>();
  verb = parent.add_subcommand("show", "Tell everything about one record of the journal");
  verb->footer(
      "Nodes are robot/epoch/index, factors source/sequence#place; numbers in m and rad, as on the "
      "wire.\n"
      "Exit codes: 0 done, 2 usage or no such record, 3 damaged, 5 no daemon answers.");
  verb->add_option("R", a->number, "the record's number; `cairn log` lists them")
      ->required()
      ->default_str("");
  add_target(*verb, a->target);
  verb->add_flag("--json", a->json, "print JSON");
  return [a] {
    return ask_and_print(a->target, {"show", {{"number", a->number}, {"json", a->json}}},
                         std::chrono::seconds(30));
  };
}

}  // namespace cairn::cli
