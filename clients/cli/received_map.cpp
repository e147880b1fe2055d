// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/received_map.hpp"

#include <map>

#include "cairn/history/export.hpp"
#include "cairn/history/map_text.hpp"
#include "clients/cli/choices.hpp"

namespace cairn::cli {

void add_map_question(CLI::App& verb, MapQuestion& question) {
  verb.add_option("--resolution", question.resolution_m, "side of a cell, m, from 0.01 to 10")
      ->type_name("M")
      ->check(CLI::Range(0.01, 10.0).description(""))
      ->capture_default_str();
  const Choices<std::string> models{{"occupancy", "occupancy"}, {"reflection", "reflection"}};
  add_choice(verb, "--model", question.model, models, "how scans become cells");
  verb.add_option("--robot", question.robot, "only the scans of this one")
      ->type_name("NAME")
      ->default_str("");
}

Result<ReceivedMap> ask_for_map(const Target& target, const MapQuestion& question) {
  Question asked{"export map"};
  asked.options["resolution"] = question.resolution_m;
  asked.options["model"] = question.model;
  asked.options["live"] = question.live;
  asked.options["with_graph"] = question.with_graph;
  if (!question.robot.empty()) asked.options["robot"] = question.robot;
  const Result<std::string> text = ask(target, asked);
  if (!text) return text.error();
  const Result<NamedFiles> files = split_files(*text);
  if (!files) return files.error();
  std::map<std::string, std::string> content(files->begin(), files->end());
  Result<MapImage> image = parse_map_text(content["map"]);
  if (!image) return image.error();
  const auto counts = nlohmann::json::parse(content["counts"], nullptr, false);
  const auto count = [&](const char* key) -> std::size_t {
    if (!counts.is_object() || !counts.contains(key) || !counts[key].is_number_unsigned()) return 0;
    return counts[key].get<std::size_t>();
  };
  return ReceivedMap{std::move(*image), count("scans"), count("missing"),
                     std::move(content["graph"])};
}

}  // namespace cairn::cli
