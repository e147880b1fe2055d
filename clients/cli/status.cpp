// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/history/record_json.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"
#include "server/replay_journal.hpp"
#include "server/status_json.hpp"

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

struct StatusArguments {
  Target target;
  bool json = false;
};

constexpr const char* kStatusFooter =
    "The daemon, the map, and one line per source: its epoch, whether it is alive, the highest "
    "sequence of which\n"
    "everything is decided, how many transactions were accepted and refused (since the daemon "
    "started; with\n"
    "--data since ever), how many wait, its clock minus the daemon's, and the last refusal.\n"
    "Exit codes: 0 done, 2 usage, 3 damaged, 5 no daemon answers.";

Result<Json> status_of_folder(const std::string& folder) {
  const auto journal = open_for_reading(folder);
  if (!journal) return journal.error();
  MapHead head;
  Sequencer sequencer;
  if (const auto replayed = replay_journal(**journal, head, sequencer); !replayed)
    return replayed.error();
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
  return to_json(status, true);
}

std::string size_text(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
  double size = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; size >= 1000.0 && unit + 1 < std::size(kUnits); ++unit) size /= 1000.0;
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %s", size, kUnits[unit]);
  return text;
}

std::string number_text(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void print_line(const char* label, const std::string& value) {
  std::printf("%-10s %s\n", label, value.c_str());
}

// Columns as wide as what they hold; the last one as it comes.
void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    std::printf("%s%s\n", line.c_str(), row.back().c_str());
  }
}

// "-" for what is not known.
std::string text_of(const Json& value) {
  if (value.is_null() || value == "") return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return value.is_string() ? value.get<std::string>() : dump(value, -1);
}

void print_sources(const Json& sources) {
  if (sources.empty()) return print_line("sources", "none yet");
  std::vector<std::vector<std::string>> rows{{"source", "epoch", "alive", "decided", "accepted",
                                              "refused", "held", "clock", "last refusal"}};
  for (const Json& source : sources) {
    char epoch[24];
    std::snprintf(epoch, sizeof epoch, "%016llx",
                  static_cast<unsigned long long>(source["epoch"].get<std::uint64_t>()));
    const Json& offset = source["clock_offset_ns"];
    rows.push_back({text_of(source["source"]), epoch, text_of(source["alive"]),
                    text_of(source["highest_decided"]), text_of(source["accepted"]),
                    text_of(source["refused"]), text_of(source["held"]),
                    offset.is_null() ? "-" : number_text("%+.3g ms", offset.get<double>() * 1e-6),
                    text_of(source["last_refusal"])});
  }
  std::printf("\n");
  print_table(rows);
}

void print_text(const Json& status) {
  if (const Json& daemon = status["daemon"]; !daemon.is_null()) {
    print_line("daemon", "cairnd " + text_of(daemon["version"]) + " on " + text_of(daemon["host"]) +
                             ", " + text_of(daemon["state"]) + " since " +
                             text_of(daemon["started"]));
  }
  print_line("head", text_of(status["head"]));
  const bool solved = status["solved_revision"] != 0;
  const Json& chi2 = status["chi2"];
  print_line("estimate", "of revision " + text_of(status["estimate_revision"]) + ", solved " +
                             (solved ? "at " + text_of(status["solved_revision"]) : "never") +
                             (chi2.is_null() ? "" : number_text(", chi2 %.9g", chi2)));
  print_line("map", text_of(status["variables"]) + " variables, " + text_of(status["factors"]) +
                        " factors");
  if (const Json& datum = status["datum"]; !datum.is_null())
    print_line("datum", number_text("%.9g N ", datum[0]) + number_text("%.9g E ", datum[1]) +
                            number_text("%.6g m", datum[2]));
  if (const Json& memory = status["memory_bytes"]; !memory.is_null())
    print_line("memory", size_text(memory));
  print_line("disk", size_text(status["disk_free_bytes"]) + " free");
  if (status["message"] != "") print_line("attention", text_of(status["message"]));
  print_sources(status["sources"]);
}

Result<Json> status_of_daemon(const Target& target) {
  const Result<std::string> text = ask(target, {"status"}, std::chrono::seconds(30));
  if (!text) return text.error();
  Json status = Json::parse(*text, nullptr, false);
  if (status.is_object() && status.contains("sources")) return status;
  return Error{ErrorCode::kInternal,
               "the daemon's status is not JSON; do client and daemon have the same version?"};
}

}  // namespace

Run add_status(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<StatusArguments>();
  verb = parent.add_subcommand("status", "Tell how a daemon is, and what its sources do");
  verb->footer(kStatusFooter);
  add_target(*verb, a->target);
  verb->add_flag("--json", a->json, "print JSON");
  return [a]() -> int {
    const Result<Json> status =
        a->target.is_folder() ? status_of_folder(a->target.folder) : status_of_daemon(a->target);
    if (!status) return fail(status.error());
    if (a->json)
      std::printf("%s\n", dump(*status).c_str());
    else
      print_text(*status);
    return kDone;
  };
}

}  // namespace cairn::cli
