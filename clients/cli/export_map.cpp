// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/export_map.hpp"

#include <map>

#include "cairn/core/exit_code.hpp"
#include "cairn/drawing/graph_picture.hpp"
#include "cairn/history/export.hpp"
#include "cairn/history/map_text.hpp"
#include "cairn/io/graph_file.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/map_files.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/target.hpp"

namespace cairn::cli {
namespace {

struct MapArguments {
  Target target;
  std::string out, robot, model = "occupancy", picture;
  double resolution_m = 0.05;
  bool live = false, quiet = false;
};

// What came as the answer.
struct ReceivedMap {
  MapImage image;
  std::size_t scans = 0, missing = 0;
  std::string graph;
};

Result<ReceivedMap> ask_for_map(const MapArguments& a) {
  Question question{"export map"};
  question.options["resolution"] = a.resolution_m;
  question.options["model"] = a.model;
  question.options["live"] = a.live;
  question.options["with_graph"] = !a.picture.empty();
  if (!a.robot.empty()) question.options["robot"] = a.robot;
  const Result<std::string> text = ask(a.target, question);
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

Result<void> draw(const ReceivedMap& map, const std::string& path) {
  constexpr std::size_t kMostPixels = std::size_t{1} << 26;
  if (map.image.cells.size() > kMostPixels || map.image.width > GrayImage::kMaxSide ||
      map.image.height > GrayImage::kMaxSide)
    return Error{ErrorCode::kNotUsable,
                 "the map has too many cells for a picture; choose larger ones with --resolution",
                 path};
  const Result<GraphDocument> graph = read_graph_text(map.graph, "the map's graph");
  if (!graph) return graph.error();
  const Se2& corner = map.image.T_map_image;
  const Backdrop backdrop{to_gray(map.image), {corner.x(), corner.y()}, map.image.resolution_m};
  GraphView view{&graph->graph};
  view.caption = std::to_string(map.scans) + " scans";
  view.backdrop = &backdrop;
  return draw_graphs({&view, 1}, path, {.title = "map"});
}

int export_map(const MapArguments& a) {
  const Result<MapPaths> paths = map_paths(a.out);
  if (!paths) return fail(paths.error());
  if (!a.picture.empty()) {
    if (auto sound = check_picture(a.picture); !sound) return fail(sound.error());
  }
  if (auto writable = check_outputs({paths->image, paths->yaml, a.picture}); !writable)
    return fail(writable.error());
  const Result<ReceivedMap> map = ask_for_map(a);
  if (!map) return fail(map.error());
  const Result<NamedFiles> files = map_files(*paths, map->image);
  if (!files) return fail(files.error());
  if (!a.picture.empty()) {
    if (auto drawn = draw(*map, a.picture); !drawn) return fail(drawn.error());
  }
  if (auto written = write_files(*files); !written) return fail(written.error());
  const Console console(false, a.quiet);
  if (map->missing > 0)
    Console::warn("warning: " + std::to_string(map->missing) +
                  " scans that keyframes name have not come; the map is without them");
  console.say(paths->image + ": " + std::to_string(map->image.width) + " x " +
              std::to_string(map->image.height) + " cells of " + std::to_string(map->scans) +
              " scans; " + paths->yaml + " says where they lie");
  if (!a.picture.empty()) console.say(a.picture + ": the map with trajectories and loop closures");
  return kDone;
}

constexpr const char* kFooter =
    "Writes an image and, beside it, the YAML file of map_server: `image, resolution, origin,\n"
    "negate, occupied_thresh, free_thresh, mode: trinary`. Pixels are 0 where it is occupied, 254\n"
    "where it is free, 205 where no scan says anything; origin is the lower left corner, y is up.\n"
    "occupancy: by log odds, an echo says p = 0.7, a beam that passes 0.4. reflection: by the "
    "part\n"
    "of scans that had an echo. Robots that no loop closure has tied to each other are drawn over\n"
    "one another; choose one with --robot.\n"
    "Exit codes: 0 done, 2 usage, 3 damaged, 4 the map cannot be settled, or has no scans "
    "(nothing\n"
    "is written), 5 no daemon answers.";

}  // namespace

std::pair<CLI::App*, Run> add_export_map(CLI::App& export_verb) {
  auto a = std::make_shared<MapArguments>();
  CLI::App* verb = export_verb.add_subcommand("map", "Write what the scans make of the ground");
  verb->footer(kFooter);
  verb->add_option("OUT", a->out, "the image: .pgm or .png (or the .yaml beside a .pgm)")
      ->required()
      ->default_str("");
  add_target(*verb, a->target);
  verb->add_option("--resolution", a->resolution_m, "side of a cell, m, from 0.01 to 10")
      ->type_name("M")
      ->check(CLI::Range(0.01, 10.0).description(""))
      ->capture_default_str();
  const Choices<std::string> models{{"occupancy", "occupancy"}, {"reflection", "reflection"}};
  add_choice(*verb, "--model", a->model, models, "how scans become cells");
  verb->add_option("--robot", a->robot, "only the scans of this one")
      ->type_name("NAME")
      ->default_str("");
  verb->add_option("--picture", a->picture,
                   "also a picture, .png or .svg, with trajectories and loop closures")
      ->type_name("OUT")
      ->default_str("");
  verb->add_flag("--live", a->live,
                 "the estimate that the daemon publishes, in place of the settled one");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return {verb, [a] { return export_map(*a); }};
}

}  // namespace cairn::cli
