// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

#include "cairn/core/exit_code.hpp"
#include "cairn/maps/character_map.hpp"
#include "clients/cli/interrupt.hpp"
#include "clients/cli/received_map.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/terminal.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct ShowArguments {
  Target target;
  MapQuestion map{.live = true};
  std::optional<double> every_s;
};

// Leaves the last lines of the screen to who it is of, and to the prompt.
Result<std::string> picture_of(const ShowArguments& a) {
  const Result<ReceivedMap> map = ask_for_map(a.target, a.map);
  if (!map) return map.error();
  CharacterGrid size = terminal_size();
  size.rows -= std::min<std::size_t>(size.rows - 1, 2);
  char facts[120];
  std::snprintf(facts, sizeof facts, "%.1f x %.1f m, %zu scans\n",
                static_cast<double>(map->image.width) * map->image.resolution_m,
                static_cast<double>(map->image.height) * map->image.resolution_m, map->scans);
  return draw_with_characters(map->image, size) + facts;
}

int watch(const ShowArguments& a) {
  const InterruptGuard guard;
  const bool in_place = isatty(STDOUT_FILENO) == 1;
  if (in_place) std::fputs("\x1b[2J", stdout);
  while (!InterruptGuard::interrupted()) {
    const auto next = std::chrono::steady_clock::now() + std::chrono::duration<double>(*a.every_s);
    const Result<std::string> picture = picture_of(a);
    const std::string text = picture ? *picture : picture.error().to_string() + '\n';
    if (in_place)
      draw_in_place(text);
    else
      std::fputs(text.c_str(), picture ? stdout : stderr);
    if (std::fflush(stdout) != 0) return kInternalError;
    while (!InterruptGuard::interrupted() && std::chrono::steady_clock::now() < next)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return kDone;
}

int show(const ShowArguments& a) {
  if (a.every_s && a.target.is_folder())
    return fail({ErrorCode::kUsage,
                 "a folder that no daemon serves does not change: --watch wants a daemon"});
  if (a.every_s) return watch(a);
  const Result<std::string> picture = picture_of(a);
  if (!picture) return fail(picture.error());
  std::fputs(picture->c_str(), stdout);
  return kDone;
}

}  // namespace

Run add_map(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ShowArguments>();
  verb = parent.add_subcommand("map", "Draw the map in the terminal");
  verb->footer(
      "A full block is occupied, a dot is free, blank is unknown. `cairn export map` writes "
      "files.\n"
      "Exit codes: 0 done, 2 usage, 3 damaged, 4 there are no scans, 5 no daemon answers.");
  add_target(*verb, a->target);
  add_map_question(*verb, a->map);
  verb->add_option("--watch", a->every_s, "show it live, so often (1 where no number is given)")
      ->expected(0, 1)
      ->default_str("")
      ->check(CLI::Range(0.1, 3600.0).description(""))
      ->type_name("[SECONDS]");
  return [a, verb]() -> int {
    if (verb->count("--watch") > 0 && !a->every_s) a->every_s = 1.0;
    return show(*a);
  };
}

}  // namespace cairn::cli
