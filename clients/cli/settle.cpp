// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/settle.hpp"

#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/history/solve_record.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct SettleArguments {
  Target target;
  bool quiet = false;
};

constexpr const char* kSettleFooter =
    "Solves the map in full: the result depends on what is in it and not on the order in which it "
    "came. With\n"
    "--data, the solve is appended to the journal, as a daemon would; where the newest record is "
    "such a solve,\n"
    "nothing is appended.\n"
    "Exit codes: 0 done, 2 usage, 3 damaged, 4 the map cannot be solved, 5 no daemon answers.";

Result<std::string> settle_folder(const std::string& folder) {
  Result<OpenFolder> open = open_for_writing(folder);
  if (!open) return open.error();
  Journal& journal = *open->journal;
  const PoseGraph map = open->head.graph();
  if (map.factors.size() == 0) return settled_text(map.graph_revision, 0.0);
  const SolveMethod method{SolveKind::kSettled, map.loops_that_merge};
  const MapSolution solution = solve_as(method, map);
  if (!solution.whole.usable())
    return Error{ErrorCode::kNotUsable, unsettled_text(solution.whole), folder};
  if (is_news(map, solution, method.kind, open->head.last_input())) {
    Revision next = journal.head().revision;
    ++next.number;
    const auto records = apply_solution(open->head, map.graph_revision, solution, next, method);
    if (const auto appended = journal.append(records); !appended) return appended.error();
  }
  return settled_text(journal.head().revision, solution.chi2);
}

Result<std::string> settle_daemon(const Target& target) {
  Result<Connection> connection = connect(target);
  if (!connection) return connection.error();
  return connection->client.command("settle", kLongWork);
}

}  // namespace

Run add_settle(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<SettleArguments>();
  verb = parent.add_subcommand("settle", "Solve a daemon's map in full, and keep the result");
  verb->footer(kSettleFooter);
  add_target(*verb, a->target);
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a]() -> int {
    const Result<std::string> settled =
        a->target.is_folder() ? settle_folder(a->target.folder) : settle_daemon(a->target);
    if (!settled) return fail(settled.error());
    Console(false, a->quiet).say(*settled);
    return kDone;
  };
}

}  // namespace cairn::cli
