// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <string>

#include "clients/cli/choices.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct LogArguments {
  Target target;
  std::optional<std::uint64_t> from, to;
  std::uint64_t limit = 100;
  std::string source, kind;
  bool json = false;
};

constexpr const char* kLogFooter =
    "One line per record: number, time of arrival, kind, source/sequence, and what it did. The "
    "newest that fit are\n"
    "shown, oldest first. `cairn show R` tells everything about one.\n"
    "--json: one JSON object per line.\n"
    "Exit codes: 0 done, 2 usage, 3 damaged, 5 no daemon answers.";

int run_log(const LogArguments& a) {
  Question question{"log"};
  if (a.from) question.options["from"] = *a.from;
  if (a.to) question.options["to"] = *a.to;
  if (!a.source.empty()) question.options["source"] = a.source;
  if (!a.kind.empty()) question.options["kind"] = a.kind;
  question.options["limit"] = a.limit;
  question.options["json"] = a.json;
  return ask_and_print(a.target, question, std::chrono::minutes(1));
}

}  // namespace

Run add_log(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<LogArguments>();
  verb = parent.add_subcommand("log", "List what the journal holds");
  verb->footer(kLogFooter);
  add_target(*verb, a->target);
  verb->add_option("--from", a->from, "from this record on")->type_name("R");
  verb->add_option("--to", a->to, "up to this record")->type_name("R");
  verb->add_option("--limit", a->limit, "at most so many; 0: all")->type_name("N");
  verb->add_option("--source", a->source, "only what this source sent")
      ->type_name("NAME")
      ->default_str("");
  const Choices<std::string> kinds{{"transaction", "transaction"},
                                   {"refusal", "refusal"},
                                   {"command", "command"},
                                   {"verdict", "verdict"},
                                   {"solve", "solve"}};
  add_choice(*verb, "--kind", a->kind, kinds, "only records of this kind");
  verb->add_flag("--json", a->json, "print JSON");
  return [a] { return run_log(*a); };
}

}  // namespace cairn::cli
