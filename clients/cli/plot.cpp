// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cairn/core/exit_code.hpp"
#include "cairn/drawing/graph_picture.hpp"
#include "cairn/drawing/ruler.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"
#include "clients/cli/graph_format.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/truth.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct PlotArguments {
  std::vector<std::string> paths;  ///< one or more graphs, then the picture
  std::string title, truth, size;
  FormatChoice format;
};

// "1200x900"; nothing where the text is something else.
std::optional<std::pair<int, int>> parse_size(const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) return std::nullopt;
  int width = 0, height = 0;
  const char *middle = text.data() + cross, *end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), middle, width);
  const auto second = std::from_chars(middle + 1, end, height);
  if (first.ec != std::errc() || first.ptr != middle || second.ec != std::errc() ||
      second.ptr != end)
    return std::nullopt;
  return std::pair(width, height);
}

std::string display_name(const std::string& path) {
  return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

Result<PictureOptions> picture_options(const PlotArguments& a) {
  const bool single = a.paths.size() == 2;
  PictureOptions options{.title = a.title, .width_px = single ? 1200 : 1600, .height_px = 900};
  for (std::size_t i = 0; a.title.empty() && i + 1 < a.paths.size(); ++i) {
    options.title += (i == 0 ? "" : ", ") + display_name(a.paths[i]);
  }
  if (a.size.empty()) return options;
  const auto size = parse_size(a.size);
  if (!size)
    return Error{ErrorCode::kUsage,
                 "'" + a.size + "' is not a size; write WIDTHxHEIGHT like 1200x900", "--size"};
  std::tie(options.width_px, options.height_px) = *size;
  return options;
}

Result<void> check_arguments(const PlotArguments& a, const PictureOptions& options) {
  if (a.paths.size() < 2)
    return Error{ErrorCode::kUsage, "name a graph and the picture: cairn plot IN OUT.svg"};
  const auto stdin_count =
      std::count(a.paths.begin(), a.paths.end(), "-") + (a.truth == "-" ? 1 : 0);
  if (stdin_count > 1)
    return Error{ErrorCode::kUsage, "standard input ('-') can be read only once"};
  if (Result<void> picture = check_picture(a.paths.back(), options); !picture) return picture;
  return check_outputs({a.paths.back()});
}

struct Panels {
  std::vector<GraphDocument> documents;
  std::vector<GraphView> views;
  std::optional<GraphDocument> truth;
  GraphTruth drawn_truth;
};

Result<void> read_panels(const PlotArguments& a, Panels& panels) {
  if (!a.truth.empty()) {
    Result<GraphDocument> truth = read_graph(a.truth);
    if (!truth) return truth.error();
    panels.truth = std::move(*truth);
    panels.drawn_truth.graph = &panels.truth->graph;
  }
  for (std::size_t i = 0; i + 1 < a.paths.size(); ++i) {
    Result<GraphDocument> document = read_graph(a.paths[i], {.format = a.format});
    if (!document) return document.error();
    panels.documents.push_back(std::move(*document));
  }
  return {};
}

Result<void> caption_panels(const PlotArguments& a, Panels& panels) {
  for (std::size_t i = 0; i < panels.documents.size(); ++i) {
    const Graph& graph = panels.documents[i].graph;
    std::string caption = "chi2 " + drawing::format_number(compute_chi2(graph), 10);
    if (panels.documents.size() > 1) caption = display_name(a.paths[i]) + ": " + caption;
    if (panels.truth) {
      const Result<TruthComparison> comparison =
          compare_with_truth(graph, graph.values(), panels.truth->graph);
      if (!comparison) return comparison.error();
      caption += ", ATE " + drawing::format_length(comparison->ate_rmse_m);
      panels.drawn_truth.T_map_truth = comparison->T_map_truth;
    }
    panels.views.push_back({.graph = &graph, .caption = caption});
  }
  return {};
}

int run_plot(const PlotArguments& a) {
  const Result<PictureOptions> options = picture_options(a);
  if (!options) return fail(options.error());
  Result<void> done = check_arguments(a, *options);
  Panels panels;
  if (done) done = read_panels(a, panels);
  if (done) done = caption_panels(a, panels);
  if (done) done = draw_graphs(panels.views, a.paths.back(), *options, panels.drawn_truth);
  return done ? kDone : fail(done.error());
}

}  // namespace

Run add_plot(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<PlotArguments>();
  verb = parent.add_subcommand("plot", "draw graphs as PNG or SVG: IN... OUT.svg|OUT.png");
  verb->add_option("FILES", a->paths, "graph files (drawn side by side), then the picture")
      ->required()
      ->default_str("")
      ->type_name("IN... OUT");
  verb->add_option("--title", a->title, "title; by default the file name")->type_name("TEXT");
  verb->add_option("--truth", a->truth,
                   "true poses: drawn underneath, trajectory error in the caption")
      ->type_name("FILE");
  verb->add_option("--size", a->size,
                   "size in pixels (default 1200x900; 1600x900 for several graphs)")
      ->type_name("WxH");
  add_choice(*verb, "--format", a->format, graph_formats(),
             "format of the input, where its content does not tell");
  verb->footer(
      "'-' reads a graph from standard input. Lines are paths; loop closures are colored by their "
      "residual.");
  return [a] { return run_plot(*a); };
}

}  // namespace cairn::cli
