// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/export.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/io/compression.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/export_map.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct ExportArguments {
  Target target;
  std::string out, robot;
  bool live = false, quiet = false;
};

// OUT.g2o -> OUTinsertion
std::string beside(const std::string& path, const std::string& ending) {
  return std::filesystem::path(path).replace_extension().string() + ending;
}

std::string without_compression(const std::string& path) {
  return compression_for(path) == Compression::kNone
             ? path
             : std::filesystem::path(path).replace_extension().string();
}

int finish(const NamedFiles& files, const ExportArguments& a, const char* what) {
  if (auto written = write_files(files); !written) return fail(written.error());
  const Console console(a.out == "-", a.quiet);
  for (const auto& [path, content] : files) {
    if (path == "-") continue;
    const auto lines = std::count(content.begin(), content.end(), '\n');
    console.say(path + ": " + std::to_string(lines) + ' ' +
                (path.ends_with(".csv") ? "lines" : what));
  }
  return kDone;
}

Result<NamedFiles> ask_for_files(const ExportArguments& a, Question question) {
  question.options["live"] = a.live;
  const Result<std::string> text = ask(a.target, question);
  if (!text) return text.error();
  return split_files(*text);
}

int export_graph(const ExportArguments& a) {
  const std::string ids = a.out == "-" ? "" : beside(without_compression(a.out), ".ids.csv");
  if (auto writable = check_outputs({a.out, ids}); !writable) return fail(writable.error());
  Result<NamedFiles> files = ask_for_files(a, {"export graph"});
  if (!files) return fail(files.error());
  NamedFiles named;
  for (auto& [name, content] : *files) {
    if (name == "graph") named.emplace_back(a.out, std::move(content));
    if (name == "ids" && !ids.empty()) named.emplace_back(ids, std::move(content));
  }
  return finish(named, a, "lines");
}

int export_trajectory(const ExportArguments& a) {
  if (auto writable = check_outputs({a.out}); !writable) return fail(writable.error());
  Question question{"export trajectory"};
  if (!a.robot.empty()) question.options["robot"] = a.robot;
  Result<NamedFiles> files = ask_for_files(a, std::move(question));
  if (!files) return fail(files.error());
  if (files->size() == 1) return finish({{a.out, std::move(files->front().second)}}, a, "poses");
  if (a.out == "-") {
    return fail({ErrorCode::kUsage, "there are " + std::to_string(files->size()) +
                                        " robots, and one standard output; choose with --robot"});
  }
  const std::string extension = std::filesystem::path(a.out).extension().string();
  NamedFiles named;
  std::vector<std::string> paths;
  for (auto& [robot, content] : *files) {
    std::string name = robot;
    std::replace(name.begin(), name.end(), '/', '_');
    named.emplace_back(beside(a.out, '-' + name + extension), std::move(content));
    paths.push_back(named.back().first);
  }
  if (auto writable = check_outputs(paths); !writable) return fail(writable.error());
  return finish(named, a, "poses");
}

void add_common(CLI::App& verb, ExportArguments& a) {
  add_target(verb, a.target);
  verb.add_flag("--live", a.live,
                "the estimate that the daemon publishes, in place of the settled one");
  verb.add_flag("-q,--quiet", a.quiet, "say nothing but warnings and errors");
}

constexpr const char* kExportCodes =
    "Exit codes: 0 done, 2 usage, 3 damaged, 4 the map cannot be settled (nothing is written), 5 "
    "no "
    "daemon answers.";

}  // namespace

Run add_export(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ExportArguments>();
  verb = parent.add_subcommand("export", "Write a daemon's map into files");
  verb->require_subcommand(1);
  CLI::App* graph = verb->add_subcommand("graph", "Write nodes and committed factors as g2o");
  graph->footer(
      std::string("Vertices stand in canonical order, whatever came first. What came from "
                  "files keeps the file's ids where they\n"
                  "are unique; all others are numbered anew, and OUT.ids.csv says "
                  "`id,robot,epoch,index` of each.\n"
                  "OUT may be '-' (no ids then), .gz and .bz2 are compressed.\n") +
      kExportCodes);
  graph->add_option("OUT", a->out, "the graph file")->required()->default_str("");
  add_common(*graph, *a);
  CLI::App* trajectory = verb->add_subcommand("trajectory", "Write the poses as TUM files");
  trajectory->footer(
      std::string("`time x y z qx qy qz qw` of T_map_body (s, m). Time is the stamp, or the index "
                  "where a robot's poses have none.\n"
                  "Of several robots each gets a file of its own, OUT-ROBOT.tum.\n") +
      kExportCodes);
  trajectory->add_option("OUT", a->out, "the TUM file")->required()->default_str("");
  trajectory->add_option("--robot", a->robot, "only this one")->type_name("NAME")->default_str("");
  add_common(*trajectory, *a);
  const auto [map, run_map] = add_export_map(*verb);
  return [a, graph, map, run_map] {
    if (map->parsed()) return run_map();
    return graph->parsed() ? export_graph(*a) : export_trajectory(*a);
  };
}

}  // namespace cairn::cli
