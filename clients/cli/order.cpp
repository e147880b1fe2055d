// SPDX-License-Identifier: BSD-3-Clause
// edge, undo, revoke, freeze and thaw: what operators change by hand.
#include "cairn/history/order.hpp"

#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/wall_clock.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct OrderArguments {
  Target target;
  std::vector<std::string> factors;
  std::uint64_t record = 0, limit = 10;
  std::string source, since, operator_name, reason;
  bool cascade = false, json = false, quiet = false;
};

// user@host
std::string whoever_asks() {
  const char* user = std::getenv("SUDO_USER");
  if (user == nullptr) user = std::getenv("USER");
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  return std::string(user == nullptr ? "somebody" : user) + '@' + host;
}

Result<std::string> order_in_folder(const std::string& folder, const Question& question) {
  if (const auto sound = question.check_text(); !sound) return sound.error();
  const Result<OpenFolder> open = open_for_writing(folder);
  if (!open) return open.error();
  const Result<Order> order = make_order(question, *open->journal, open->head);
  if (!order) return order.error();
  if (order->changes_nothing()) return count_changes({});
  const RecordBody record = to_record(*order, question, wall_clock_ns());
  const Result<Revision> appended = open->journal->append({&record, 1});
  if (!appended) return appended.error();
  return count_changes(*order) + ", record " + std::to_string(appended->number);
}

int give(const OrderArguments& a, Question question) {
  question.options["operator"] = a.operator_name.empty() ? whoever_asks() : a.operator_name;
  question.options["reason"] = a.reason;
  const Result<std::string> done = a.target.is_folder() ? order_in_folder(a.target.folder, question)
                                                        : ask(a.target, question, kLongWork);
  if (!done) return fail(done.error());
  Console(false, a.quiet).say(*done);
  return kDone;
}

void add_who_and_why(CLI::App& verb, OrderArguments& a) {
  verb.add_option("--reason", a.reason, "why; kept in the journal")
      ->type_name("TEXT")
      ->default_str("");
  verb.add_option("--operator", a.operator_name,
                  "who; kept in the journal (else you, at this host)")
      ->type_name("NAME")
      ->default_str("");
  add_target(verb, a.target);
  verb.add_flag("-q,--quiet", a.quiet, "say nothing but warnings and errors");
}

constexpr const char* kOrderCodes =
    "Exit codes: 0 done, 2 usage or no such factor, 3 damaged, 4 not possible any more, 5 no "
    "daemon "
    "answers.";

}  // namespace

Run add_edge(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<OrderArguments>();
  verb = parent.add_subcommand("edge", "Show factors, or switch them off and on by hand");
  verb->footer(std::string("A factor is RECORD:PLACE (12:0), or RECORD for all of a record's; "
                           "`cairn log` lists records.\n"
                           "What was switched off takes no part in estimates; what was removed "
                           "never comes back.\n"
                           "The gate decides which loop closures are in; one that is trusted is in "
                           "whatever it says,\nuntil it is doubted.\n") +
               kOrderCodes);
  verb->require_subcommand(1);
  CLI::App* show = verb->add_subcommand("show", "The factors of a record, as they stand now");
  show->add_option("RECORD", a->record, "its number")->required()->default_str("");
  show->add_flag("--json", a->json, "print JSON");
  add_target(*show, a->target);
  CLI::App* worst = verb->add_subcommand(
      "worst", "The factors that fit the map worst: where to look for a false loop");
  worst->add_option("--limit", a->limit, "so many")->type_name("N");
  worst->add_flag("--json", a->json, "print JSON");
  add_target(*worst, a->target);
  const std::pair<const char*, const char*> changes[] = {
      {"disable", "Leave these factors out of estimates"},
      {"enable", "Take these factors into estimates again"},
      {"remove", "Leave these factors out of estimates for ever"},
      {"trust", "Have these loop closures in estimates, whatever the gate says"},
      {"doubt", "Leave it to the gate again whether these loop closures are in"}};
  for (const auto& [change, meaning] : changes) {
    CLI::App* sub = verb->add_subcommand(change, meaning);
    sub->add_option("FACTOR", a->factors, "RECORD:PLACE or RECORD")->required()->default_str("");
    add_who_and_why(*sub, *a);
  }
  return [a, verb] {
    const CLI::App* chosen = verb->get_subcommands().front();
    if (chosen->get_name() == "show")
      return ask_and_print(a->target, {"edge show", {{"record", a->record}, {"json", a->json}}},
                           std::chrono::seconds(30));
    if (chosen->get_name() == "worst")
      return ask_and_print(a->target, {"edge worst", {{"limit", a->limit}, {"json", a->json}}},
                           std::chrono::seconds(30));
    return give(*a, {"edge " + chosen->get_name(), {{"factors", a->factors}}});
  };
}

Run add_undo(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<OrderArguments>();
  verb = parent.add_subcommand("undo", "Take back a transaction or an operator's order");
  verb->footer(std::string("The map is as if the transaction had never come; the journal keeps "
                           "both. Undoing the undo brings it back.\n") +
               kOrderCodes);
  verb->add_option("R", a->record, "the record's number; `cairn log` lists them")
      ->required()
      ->default_str("");
  verb->add_flag("--cascade", a->cascade, "also what later records have built on it");
  add_who_and_why(*verb, *a);
  return [a] { return give(*a, {"undo", {{"record", a->record}, {"cascade", a->cascade}}}); };
}

Run add_freeze(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<OrderArguments>();
  verb = parent.add_subcommand("freeze", "Keep the map as it is: robots only localize against it");
  verb->footer(
      std::string("The map is settled first. From then on no node of it moves: what comes later is "
                  "placed\nagainst it by its odometry and its loop closures. `cairn thaw` lets all "
                  "move again.\nWith --data, the map must be settled (`cairn settle`).\n") +
      kOrderCodes);
  add_who_and_why(*verb, *a);
  return [a] { return give(*a, {"freeze", {}}); };
}

Run add_thaw(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<OrderArguments>();
  verb = parent.add_subcommand("thaw", "Let a frozen map move again");
  verb->footer(kOrderCodes);
  add_who_and_why(*verb, *a);
  return [a] { return give(*a, {"thaw", {}}); };
}

Run add_revoke(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<OrderArguments>();
  verb = parent.add_subcommand("revoke", "Take back everything that a source has sent since then");
  verb->footer(std::string("The map is as if nothing of that source had come since; what it sends "
                           "from now on is taken.\n"
                           "`cairn undo` of the revocation brings it back. Times are those of the "
                           "daemon's clock: where\n"
                           "that was set back, name a record.\n") +
               kOrderCodes);
  verb->add_option("--source", a->source, "its name; `cairn status` lists them")
      ->required()
      ->type_name("S")
      ->default_str("");
  verb->add_option("--since", a->since,
                   "a record's number, or a UTC time as `cairn log` prints it; with what came then")
      ->required()
      ->type_name("T")
      ->default_str("");
  verb->add_flag("--cascade", a->cascade, "also what other sources have built on it");
  add_who_and_why(*verb, *a);
  return [a] {
    return give(*a,
                {"revoke", {{"source", a->source}, {"since", a->since}, {"cascade", a->cascade}}});
  };
}

}  // namespace cairn::cli
