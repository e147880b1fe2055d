// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/export_map.hpp"

#include <filesystem>

#include "cairn/core/exit_code.hpp"
#include "cairn/drawing/graph_picture.hpp"
#include "cairn/history/export.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/io/map_file.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/received_map.hpp"

namespace cairn::cli {
namespace {

struct MapArguments {
  Target target;
  MapQuestion map;
  std::string out, picture;
  bool quiet = false;
};

GrayImage to_gray(const MapImage& map) { return {map.width, map.height, gray_levels(map)}; }

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

struct MapPaths {
  std::string image, yaml;
};

Result<MapPaths> paths_of(const std::string& out) {
  const std::filesystem::path path(out);
  const std::string extension = path.extension().string();
  const auto with = [&](const char* ending) {
    return std::filesystem::path(path).replace_extension(ending).string();
  };
  if (extension == ".pgm" || extension == ".png") return MapPaths{out, with(".yaml")};
  if (extension == ".yaml") return MapPaths{with(".pgm"), out};
  return Error{ErrorCode::kUsage, "a map must be named .pgm, .png or .yaml", out};
}

Result<NamedFiles> make_files(const MapPaths& paths, const MapImage& map) {
  const Result<std::string> yaml =
      write_map_yaml(map, std::filesystem::path(paths.image).filename().string());
  if (!yaml) return yaml.error();
  if (paths.image.ends_with(".pgm"))
    return NamedFiles{{paths.image, write_pgm(map)}, {paths.yaml, *yaml}};
  const Result<std::string> png = encode_png(to_gray(map));
  if (!png) return png.error();
  return NamedFiles{{paths.image, *png}, {paths.yaml, *yaml}};
}

int export_map(const MapArguments& a) {
  const Result<MapPaths> paths = paths_of(a.out);
  if (!paths) return fail(paths.error());
  if (!a.picture.empty()) {
    if (auto sound = check_picture(a.picture); !sound) return fail(sound.error());
  }
  if (auto writable = check_outputs({paths->image, paths->yaml, a.picture}); !writable)
    return fail(writable.error());
  const Result<ReceivedMap> map = ask_for_map(a.target, a.map);
  if (!map) return fail(map.error());
  const Result<NamedFiles> files = make_files(*paths, map->image);
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
  add_map_question(*verb, a->map);
  verb->add_option("--picture", a->picture,
                   "also a picture, .png or .svg, with trajectories and loop closures")
      ->type_name("OUT")
      ->default_str("");
  verb->add_flag("--live", a->map.live,
                 "the estimate that the daemon publishes, in place of the settled one");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return {verb, [a] {
            a->map.with_graph = !a->picture.empty();
            return export_map(*a);
          }};
}

}  // namespace cairn::cli
