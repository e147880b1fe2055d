// SPDX-License-Identifier: BSD-3-Clause
// The daemon's live map, tile by tile.
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cairn/core/exit_code.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/interrupt.hpp"
#include "clients/cli/map_files.hpp"
#include "clients/cli/map_text.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

struct LiveMapArguments {
  Target target;
  std::string out, map;
  std::uint32_t budget_kb = 256;
  std::optional<double> every_s;  ///< watch
  bool quiet = false;

  [[nodiscard]] Clock::duration timeout() const {
    return std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(target.timeout_s));
  }
};

constexpr const char* kFooter =
    "The map that the daemon keeps up to date while robots drive, in characters ('#' occupied, '.' "
    "free), or\n"
    "written to OUT.pgm or OUT.png with map_server's YAML beside it. What comes over the network "
    "are tiles, the\n"
    "nearest to the map's origin first; with --watch, only those that have changed. The daemon's "
    "configuration says\n"
    "how fine the map is (maps: resolution_m). `cairn export map` renders one as fine as you like, "
    "also of a folder.\n"
    "Robots that no loop closure has tied to each other have maps of their own: the largest is "
    "shown, or that of --map.\n"
    "With --watch, drawn in place on a terminal, else a line for each change; OUT is written anew "
    "each time. Ctrl-C\n"
    "ends it.\n"
    "Exit codes: 0 done, 2 usage, 4 there is no map (yet), 5 no daemon answers.";

// What the daemon says of its maps.
Result<Json> ask_for_facts(Client& client) {
  const Result<std::string> text = client.command("status", std::chrono::seconds(5));
  if (!text) return text.error();
  const Json status = Json::parse(*text, nullptr, false);
  if (!status.is_object() || !status.contains("maps"))
    return Error{ErrorCode::kNotUsable, "this daemon knows no maps: it is older than this program"};
  if (status["maps"].is_object()) return status["maps"];
  return Error{ErrorCode::kNotUsable,
               "this daemon renders no maps; set maps: {enabled: true} in its configuration"};
}

std::size_t tiles_of(const std::vector<MapView>& views) {
  std::size_t tiles = 0;
  for (const MapView& view : views) tiles += view.tiles.size();
  return tiles;
}

bool is_whole(const std::vector<MapView>& views, const Json& facts) {
  return facts.value("behind", 1U) == 0 && !facts.value("rendering", true) &&
         std::all_of(views.begin(), views.end(), [](const auto& v) { return v.missing == 0; }) &&
         tiles_of(views) == facts.value("tiles", std::size_t{0});
}

// Waits as long as something moves. What has come by then is as good as it gets: a robot that
// drives is always a little ahead of its map.
Result<std::vector<MapView>> fetch(Client& client, const LiveMapArguments& a,
                                   const Console& console) {
  auto give_up = Clock::now() + a.timeout();
  std::size_t had = 0;
  while (!InterruptGuard::interrupted()) {
    const Result<Json> facts = ask_for_facts(client);
    if (!facts) return facts.error();
    std::vector<MapView> views = client.maps();
    const std::size_t tiles = tiles_of(views);
    const bool whole = is_whole(views, *facts);
    if (tiles != std::exchange(had, tiles) || facts->value("rendering", false))
      give_up = Clock::now() + a.timeout();
    console.show_progress(std::to_string(tiles) + " tiles");
    if (whole || Clock::now() > give_up) {
      console.clear_progress();
      if (tiles == 0)
        return Error{ErrorCode::kNotUsable, "no keyframe of this map has a laser scan yet"};
      if (!whole) Console::warn("warning: the daemon is still rendering; this is what there is");
      return views;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return Error{ErrorCode::kNotUsable, "interrupted"};
}

// The one that is asked for, or the largest.
Result<MapView> choose(std::vector<MapView> views, const std::string& wanted) {
  std::string names;
  for (const MapView& view : views) names += (names.empty() ? "" : ", ") + view.map;
  std::erase_if(views, [&](const MapView& v) {
    return v.tiles.empty() || (!wanted.empty() && v.map != wanted);
  });
  if (views.empty())
    return Error{ErrorCode::kUsage, "there is no map '" + wanted + "'; those there are: " + names};
  return *std::max_element(views.begin(), views.end(), [](const MapView& x, const MapView& y) {
    return x.tiles.size() < y.tiles.size();
  });
}

std::string describe(const MapView& view, const MapImage& image, std::size_t maps) {
  char size[96];
  std::snprintf(size, sizeof size, ": %zu tiles, %.1f m x %.1f m in cells of %g m, revision ",
                view.tiles.size(), static_cast<double>(image.width) * view.resolution_m,
                static_cast<double>(image.height) * view.resolution_m, view.resolution_m);
  return "map " + view.map + size + std::to_string(view.estimate.graph.number) +
         (maps > 1 ? " (one of " + std::to_string(maps) + " maps: --map)" : "");
}

std::string draw(const MapImage& image) {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row < 4 || size.ws_col < 10)
    size = {24, 80, 0, 0};
  return picture_in_text(image, size.ws_col, size.ws_row - 2U);
}

enum class Style { kOnce, kInPlace, kLines };

int show(std::vector<MapView> views, const LiveMapArguments& a, const Console& console,
         Style style) {
  const std::size_t maps = views.size();
  const Result<MapView> view = choose(std::move(views), a.map);
  if (!view) return fail(view.error());
  const Result<MapImage> image = draw_tiles(view->tiles, view->resolution_m);
  if (!image) return fail(image.error());
  if (!a.out.empty()) {
    const Result<MapPaths> paths = map_paths(a.out);
    const Result<NamedFiles> files = paths ? map_files(*paths, *image) : paths.error();
    if (!files) return fail(files.error());
    if (auto written = write_files(*files); !written) return fail(written.error());
  }
  const std::string line = describe(*view, *image, maps);
  if (style == Style::kInPlace)
    std::printf("\x1b[H\x1b[J%s%s\n", draw(*image).c_str(), line.c_str());
  else if (style == Style::kOnce && a.out.empty())
    std::printf("%s%s\n", draw(*image).c_str(), line.c_str());
  else
    console.say((a.out.empty() ? "" : a.out + ": ") + line);
  return std::fflush(stdout) == 0 ? kDone : kInternalError;
}

int watch(Client& client, const LiveMapArguments& a, const Console& console) {
  const Style style = a.out.empty() && isatty(STDOUT_FILENO) == 1 ? Style::kInPlace : Style::kLines;
  std::atomic<std::uint64_t> changes{0};
  client.on_maps([&](const MapChange&) { ++changes; });
  std::uint64_t shown = 0;
  int code = kDone;
  while (!InterruptGuard::interrupted() && code == kDone) {
    const auto next = Clock::now() + std::chrono::duration<double>(*a.every_s);
    if (const std::uint64_t now = changes; now != std::exchange(shown, now))
      if (auto views = client.maps(); tiles_of(views) > 0)
        code = show(std::move(views), a, console, style);
    while (!InterruptGuard::interrupted() && Clock::now() < next)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  client.on_maps({});
  return code;
}

int show_map(const LiveMapArguments& a) {
  if (!a.out.empty()) {
    const Result<MapPaths> paths = map_paths(a.out);
    if (!paths) return fail(paths.error());
    if (auto writable = check_outputs({paths->image, paths->yaml}); !writable)
      return fail(writable.error());
  }
  Result<Connection> connection =
      connect(a.target, {.follow_maps = true, .maps = {.budget_bytes = a.budget_kb << 10}});
  if (!connection) return fail(connection.error());
  const InterruptGuard guard;
  const Console console(false, a.quiet);
  if (a.every_s) {
    if (const auto facts = ask_for_facts(connection->client); !facts) return fail(facts.error());
    return watch(connection->client, a, console);
  }
  Result<std::vector<MapView>> views = fetch(connection->client, a, console);
  if (!views) return fail(views.error());
  return show(std::move(*views), a, console, Style::kOnce);
}

}  // namespace

Run add_map(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<LiveMapArguments>();
  verb = parent.add_subcommand("map", "Show a daemon's live map, once or as it grows");
  verb->footer(kFooter);
  verb->add_option("OUT", a->out,
                   "the image: .pgm or .png (or the .yaml beside a .pgm); else the "
                   "map is drawn here")
      ->default_str("");
  add_daemon(*verb, a->target);
  verb->add_option("--map", a->map, "the map of this name, such as robot/17")
      ->type_name("NAME")
      ->default_str("");
  verb->add_option("--budget", a->budget_kb, "KB of tiles in one answer, for slow links")
      ->check(in_range(8, 1024))
      ->type_name("KB");
  verb->add_option("--watch", a->every_s, "go on, at most so often (1 where no number is given)")
      ->expected(0, 1)
      ->default_str("")
      ->check(CLI::Range(0.1, 3600.0).description(""))
      ->type_name("[SECONDS]");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a, verb]() -> int {
    if (verb->count("--watch") > 0 && !a->every_s) a->every_s = 1.0;
    return show_map(*a);
  };
}

}  // namespace cairn::cli
