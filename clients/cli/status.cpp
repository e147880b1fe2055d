// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "cairn/core/exit_code.hpp"
#include "cairn/history/record_json.hpp"
#include "clients/cli/interrupt.hpp"
#include "clients/cli/status_text.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/terminal.hpp"
#include "clients/cli/verb.hpp"
#include "server/replay_journal.hpp"
#include "server/status_json.hpp"

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

struct StatusArguments {
  Target target;
  bool json = false;
  std::optional<double> every_s;  ///< watch
};

constexpr const char* kStatusFooter =
    "The daemon, the map, and one line per source: its epoch, whether it is alive, the highest "
    "sequence of which\n"
    "everything is decided, how many transactions were accepted and refused (since the daemon "
    "started; with\n"
    "--data since ever), how many wait, how many of its loops are quarantined, its clock minus the "
    "daemon's, and the\n"
    "last refusal. Latencies are of the last minute, in bins nine percent wide: from a "
    "transaction's arrival to its\n"
    "receipt, and from that of a loop closure to the poses solved with it.\n"
    "Trust: the errors of what a source sends, seen from everything else, in sigmas that it "
    "states; the median of\n"
    "all its odometry, or loops, of one robot. 3.1x over-confident: they are 3.1 times as large as "
    "stated. Measured\n"
    "when the map is settled, and every 30 s.\n"
    "With --watch, drawn again in place on a terminal, else one after the other; with --json one "
    "object per line.\n"
    "Ctrl-C ends it.\n"
    "Exit codes: 0 done, 2 usage, 3 damaged, 5 no daemon answers.";

Result<Json> status_of_folder(const std::string& folder) {
  const auto journal = open_for_reading(folder);
  if (!journal) return journal.error();
  MapHead head;
  Sequencer sequencer;
  const auto replayed = replay_journal(**journal, head, sequencer);
  if (!replayed) return replayed.error();
  Status status;
  status.head = (*journal)->head().revision;
  status.estimate = {head.graph().graph_revision, head.graph().solved_revision};
  status.variables = head.graph().nodes.size();
  status.factors = head.graph().factors.size();
  status.datum = head.graph().datum;
  std::error_code ignored;
  status.disk_free_bytes = std::filesystem::space(folder, ignored).available;
  for (const auto& [name, counters] : sequencer.counters()) {
    SourceStatus source;
    source.source = name;
    source.epoch = counters.epoch;
    source.highest_decided = counters.highest_decided;
    status.sources.push_back(std::move(source));
  }
  // What the sequencer counts is of a daemon's life; the journal knows all of it.
  const Result<void> counted = (*journal)->for_each(1, [&](const Record& record) -> Result<void> {
    const TransactionKey* key = key_of(record);
    if (key == nullptr) return {};
    for (SourceStatus& source : status.sources) {
      if (source.source != key->source) continue;
      const auto& outcome = std::get<TransactionRecord>(record.body).outcome;
      const auto* refused = std::get_if<RefusedTransaction>(&outcome);
      ++(refused != nullptr ? source.refused : source.accepted);
      if (refused != nullptr)
        source.last_refusal = std::string(to_string(refused->code)) + ": " + refused->reason;
    }
    return {};
  });
  if (!counted) return counted.error();
  Json json = to_json(status, true);
  add_judgement(json, head, replayed->quarantined, measure_trust(head.graph()));
  return json;
}

Result<Json> status_of_daemon(Client& client, std::chrono::seconds patience) {
  const Result<std::string> text = client.command("status", patience);
  if (!text) return text.error();
  Json status = Json::parse(*text, nullptr, false);
  if (status.is_object() && status.contains("sources")) return status;
  return Error{ErrorCode::kInternal,
               "the daemon's status is not JSON; do client and daemon have the same version?"};
}

void print(const Json& status, bool as_json) {
  std::fputs((as_json ? dump(status) + '\n' : text_of_status(status)).c_str(), stdout);
}

int watch(Client& client, const StatusArguments& a) {
  const InterruptGuard guard;
  const bool in_place = !a.json && isatty(STDOUT_FILENO) == 1;
  if (in_place) std::fputs("\x1b[2J", stdout);
  while (!InterruptGuard::interrupted()) {
    const auto next = std::chrono::steady_clock::now() + std::chrono::duration<double>(*a.every_s);
    const Result<Json> status = status_of_daemon(client, std::chrono::seconds(5));
    if (!status && in_place)  // it may come back
      draw_in_place(status.error().to_string());
    else if (!status)
      (void)fail(status.error());
    else if (a.json)
      std::printf("%s\n", dump(*status, -1).c_str());
    else if (in_place)
      draw_in_place(text_of_status(*status));
    else
      std::printf("%s\n", text_of_status(*status).c_str());
    if (std::fflush(stdout) != 0) return kInternalError;
    while (!InterruptGuard::interrupted() && std::chrono::steady_clock::now() < next)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return kDone;
}

int tell_status(const StatusArguments& a) {
  if (a.target.is_folder()) {
    if (a.every_s)
      return fail({ErrorCode::kUsage,
                   "a folder that no daemon serves does not change: --watch wants a daemon"});
    const Result<Json> status = status_of_folder(a.target.folder);
    if (!status) return fail(status.error());
    print(*status, a.json);
    return kDone;
  }
  Result<Connection> connection = connect(a.target);
  if (!connection) return fail(connection.error());
  if (a.every_s) return watch(connection->client, a);
  const Result<Json> status = status_of_daemon(connection->client, std::chrono::seconds(30));
  if (!status) return fail(status.error());
  print(*status, a.json);
  return kDone;
}

}  // namespace

Run add_status(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<StatusArguments>();
  verb = parent.add_subcommand("status", "Tell how a daemon is, and what its sources do");
  verb->footer(kStatusFooter);
  add_target(*verb, a->target);
  verb->add_flag("--json", a->json, "print JSON");
  verb->add_option("--watch", a->every_s, "show it live, so often (1 where no number is given)")
      ->expected(0, 1)
      ->default_str("")
      ->check(CLI::Range(0.1, 3600.0).description(""))
      ->type_name("[SECONDS]");
  return [a, verb]() -> int {
    if (verb->count("--watch") > 0 && !a->every_s) a->every_s = 1.0;
    return tell_status(*a);
  };
}

}  // namespace cairn::cli
