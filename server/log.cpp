// SPDX-License-Identifier: BSD-3-Clause
#include "server/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

namespace cairn {
namespace {

constexpr const char* kName = "cairnd";
constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::info, spdlog::level::warn,
                                                 spdlog::level::err};

bool writes_json = false;  // set before threads start

spdlog::level::level_enum level_of(Severity severity) {
  return kLevels[static_cast<std::size_t>(severity)];
}

// The members of an object, without its braces: the pattern puts time and level before them.
std::string json_members(std::string_view kind, std::string_view text, const Revision& revision) {
  nlohmann::ordered_json line{{"kind", kind}, {"text", text}};
  if (revision != Revision{}) line["revision"] = to_string(revision);
  const std::string object =
      line.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
  return object.substr(1, object.size() - 2);
}

std::string plain_line(std::string_view kind, std::string_view text, const Revision& revision) {
  std::string line = std::string(kind) + ": " + std::string(text);
  if (revision != Revision{}) line += " (at " + to_string(revision) + ')';
  return line;
}

}  // namespace

void open_log(LogFormat format, Severity from) {
  writes_json = format == LogFormat::kJson;
  spdlog::drop(kName);
  spdlog::set_default_logger(writes_json ? spdlog::stderr_logger_mt(kName)
                                         : spdlog::stderr_color_mt(kName));
  spdlog::set_level(level_of(from));
  if (writes_json) {
    spdlog::set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%fZ","level":"%l",%v})",
                        spdlog::pattern_time_type::utc);
  }
}

void log(Severity severity, std::string_view kind, std::string_view text,
         const Revision& revision) {
  spdlog::log(level_of(severity), "{}",
              writes_json ? json_members(kind, text, revision) : plain_line(kind, text, revision));
}

}  // namespace cairn
