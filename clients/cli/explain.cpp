// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct ExplainArguments {
  Target target;
  std::string name;
  bool json = false;
};

}  // namespace

Run add_explain(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ExplainArguments>();
  verb = parent.add_subcommand(
      "explain", "Tell why a factor is in the map or out of it, or why a node is where it is");
  verb->footer(
      "Of an edge: every verdict and order; chi2 of the map with it and without it (the other "
      "factors "
      "stay as they\nare); how far it is off, in sigmas of its own and of where the map without it "
      "puts its nodes; and of a loop closure\nthe smallest set of edges that contradict it: the "
      "shortest chain of other edges between its ends whose cycle with it\nno gate would believe, "
      "and what the gate would decide were it trusted (or disabled).\n"
      "Of a node: its estimate, its sigmas (in its own frame, relative to the gauge), its factors, "
      "those that are out first.\n"
      "The map is solved a few times, by the daemon beside its work.\n"
      "Exit codes: 0 done, 2 usage or no such name, 3 damaged, 5 no daemon answers.");
  verb->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, const char* argument, const char* help) {
    CLI::App* sub = verb->add_subcommand(name, what);
    sub->add_option(argument, a->name, help)->required()->default_str("");
    sub->add_flag("--json", a->json, "print JSON");
    add_target(*sub, a->target);
  };
  add("edge", "What was said of a factor, and what the map would be without it", "FACTOR",
      "RECORD:PLACE, as cairn edge show prints it");
  add("node", "Where a node is, how well that is known, and what says so", "NODE",
      "ROBOT/EPOCH/INDEX, or RECORD:PLACE of the variable that a record brought");
  return [a, verb] {
    const bool edge = verb->get_subcommands().front()->get_name() == "edge";
    return ask_and_print(a->target, {edge ? "explain edge" : "explain node",
                                     {{edge ? "factor" : "node", a->name}, {"json", a->json}}});
  };
}

}  // namespace cairn::cli
