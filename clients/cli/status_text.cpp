// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/status_text.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "cairn/history/question.hpp"

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

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

std::string line(const std::string& label, const std::string& value) {
  std::string text = label;
  text.resize(std::max<std::size_t>(label.size(), 10), ' ');
  return text + ' ' + value + '\n';
}

// Columns as wide as what they hold; the last one as it comes.
std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = "\n";
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    text += line + row.back() + '\n';
  }
  return text;
}

// "-" for what is not known. Names come from strangers: nothing in them moves the cursor.
std::string text_of(const Json& value) {
  if (value.is_null() || value == "") return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  std::string text = value.is_string() ? value.get<std::string>() : dump(value, -1);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return text;
}

std::string sources_text(const Json& sources) {
  if (sources.empty()) return line("sources", "none yet");
  std::vector<std::vector<std::string>> rows{{"source", "epoch", "alive", "decided", "accepted",
                                              "refused", "held", "out", "clock", "last refusal"}};
  for (const Json& source : sources) {
    char epoch[24];
    std::snprintf(epoch, sizeof epoch, "%016llx",
                  static_cast<unsigned long long>(source["epoch"].get<std::uint64_t>()));
    const Json& offset = source["clock_offset_ns"];
    rows.push_back({text_of(source["source"]), epoch, text_of(source["alive"]),
                    text_of(source["highest_decided"]), text_of(source["accepted"]),
                    text_of(source["refused"]), text_of(source["held"]),
                    text_of(source.value("quarantined", Json())),
                    offset.is_null() ? "-" : number_text("%+.3g ms", offset.get<double>() * 1e-6),
                    text_of(source["last_refusal"])});
  }
  return table(rows);
}

std::string head_text(const Json& status) {
  std::string text;
  if (const Json& daemon = status["daemon"]; !daemon.is_null()) {
    text += line("daemon", "cairnd " + text_of(daemon["version"]) + " on " +
                               text_of(daemon["host"]) + ", " + text_of(daemon["state"]) +
                               " since " + text_of(daemon["started"]));
  }
  text += line("head", text_of(status["head"]));
  const bool solved = status["solved_revision"] != 0;
  const Json& chi2 = status["chi2"];
  text += line("estimate", "of revision " + text_of(status["estimate_revision"]) + ", solved " +
                               (solved ? "at " + text_of(status["solved_revision"]) : "never") +
                               (chi2.is_null() ? "" : number_text(", chi2 %.9g", chi2)));
  text += line("map", text_of(status["variables"]) + " variables, " + text_of(status["factors"]) +
                          " factors");
  if (const Json& datum = status["datum"]; !datum.is_null())
    text += line("datum", number_text("%.9g N ", datum[0]) + number_text("%.9g E ", datum[1]) +
                              number_text("%.6g m", datum[2]));
  if (const Json& memory = status["memory_bytes"]; !memory.is_null())
    text += line("memory", size_text(memory));
  text += line("disk", size_text(status["disk_free_bytes"]) + " free");
  if (status["message"] != "") text += line("attention", text_of(status["message"]));
  return text;
}

// Null where a daemon of another version does not say it.
Json part(const Json& status, const char* key) { return status.value(key, Json()); }

std::string ms_text(double ms) { return number_text(ms < 100.0 ? "%.3g" : "%.0f", ms); }

std::string latency_text(const Json& latency) {
  const std::uint64_t count = latency.value("count", std::uint64_t{0});
  if (count == 0) return "none in the last minute";
  return "p50 " + ms_text(latency.value("p50_ms", 0.0)) + ", p99 " +
         ms_text(latency.value("p99_ms", 0.0)) + ", at most " +
         ms_text(latency.value("max_ms", 0.0)) + " ms (" + std::to_string(count) + ')';
}

std::string vitals_text(const Json& status) {
  std::string text;
  if (const Json solver = part(status, "solver"); solver.is_object())
    text += line("solver", solver.value("running", false)
                               ? text_of(part(solver, "kind")) +
                                     number_text(", for %.2g s", solver.value("seconds", 0.0))
                               : "idle");
  if (const Json queues = part(status, "queues"); queues.is_object())
    text += line("queues", text_of(part(queues, "inbox_messages")) + " messages (" +
                               size_text(queues.value("inbox_bytes", std::uint64_t{0})) + "), " +
                               text_of(part(queues, "held")) + " held, " +
                               text_of(part(queues, "closures_to_solve")) + " closures to solve, " +
                               text_of(part(queues, "commands_awaiting_solve")) + " commands, " +
                               text_of(part(queues, "payloads")) + " payloads (" +
                               size_text(queues.value("payload_bytes", std::uint64_t{0})) + ')');
  if (const Json maps = part(status, "maps"); maps.is_object())
    text +=
        line("maps",
             text_of(part(maps, "scans")) + " scans in " + text_of(part(maps, "tiles")) +
                 " tiles, rendered to revision " + text_of(part(maps, "rendered_revision")) + " (" +
                 text_of(part(maps, "behind")) + " behind), " + text_of(part(maps, "missing")) +
                 " scans missing" + (maps.value("full", false) ? ", FULL (maps: most_mb)" : ""));
  if (const Json latency = part(status, "latency"); latency.is_object()) {
    text += line("receipts", latency_text(part(latency, "receipt")));
    text += line("closures", latency_text(part(latency, "closure_to_poses")));
  }
  return text;
}

std::string quarantine_text(const Json& quarantine) {
  if (!quarantine.is_object() || quarantine.value("count", 0) == 0) return "";
  std::vector<std::vector<std::string>> rows{{"quarantined", "ties", "because"}};
  for (const Json& loop : part(quarantine, "newest")) {
    std::string ties;
    for (const Json& node : part(loop, "nodes"))
      ties += (ties.empty() ? "" : " - ") + text_of(node);
    rows.push_back({text_of(part(loop, "factor")), ties,
                    text_of(part(loop, "test")) + number_text(": %.4g", loop.value("value", 0.0)) +
                        number_text(" (limit %.4g)", loop.value("limit", 0.0))});
  }
  return table(rows);
}

std::string trust_text(const Json& trust) {
  if (!trust.is_array() || trust.empty()) return "";
  std::vector<std::vector<std::string>> rows{{"covariances of", "robot", "kind", "factors", "are"}};
  for (const Json& row : trust)
    rows.push_back({text_of(part(row, "source")), text_of(part(row, "robot")),
                    text_of(part(row, "kind")), text_of(part(row, "factors")),
                    text_of(part(row, "words"))});
  return table(rows);
}

}  // namespace

std::string text_of_status(const Json& status) {
  return head_text(status) + vitals_text(status) + sources_text(status["sources"]) +
         trust_text(part(status, "trust")) + quarantine_text(part(status, "quarantine"));
}

}  // namespace cairn::cli
