// SPDX-License-Identifier: BSD-3-Clause
// Which false loops does the gate find, and what do those that it misses do to the map?
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include "benchmarks/support/gate_scores.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/solver/loop_gate.hpp"
#include "cairn/solver/optimize.hpp"
#include "datasets/false_loops.hpp"

namespace cairn::bench {
namespace {

const SolveOptions kOptions{.init = InitMethod::kAuto};

std::optional<Graph> load_files(const std::string& name, const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) files.push_back(data_folder() + "/" + path);
  auto document = read_graphs(files);
  if (document) return std::move(document->graph);
  std::fprintf(stderr, "%s is left out: %s\n", name.c_str(), document.error().to_string().c_str());
  return std::nullopt;
}

std::vector<std::string> four_robots(const std::string& name) {
  std::vector<std::string> paths;
  for (const char* robot : {"0", "1", "2", "3"})
    paths.push_back("graphs/multirobot/" + name + "_4robots/" + robot + ".g2o");
  return paths;
}

struct Gated {
  Graph graph;
  GatedSolution solution;
  std::set<std::size_t> left_out;
  double seconds;
};

Gated run_gate(Graph graph) {
  const Stopwatch watch;
  GatedSolution solution = solve_gated(graph, kOptions);
  Gated gated{std::move(graph), std::move(solution), {}, watch.seconds()};
  for (const LeftOutLoop& loop : gated.solution.left_out) gated.left_out.insert(loop.factor);
  return gated;
}

std::set<std::size_t> without(const std::set<std::size_t>& all, const std::set<std::size_t>& some) {
  std::set<std::size_t> rest;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(),
                      std::inserter(rest, rest.end()));
  return rest;
}

std::string percent(double part) { return number_text(100.0 * part, 1) + " %"; }
std::string of(std::size_t part, std::size_t all) {
  return std::to_string(part) + " of " + std::to_string(all);
}

struct Set {
  std::string name;
  std::vector<std::string> paths;
  std::size_t false_loops;
  bool between_robots = false;
};

// What several seeds of one set add up to.
struct Tally {
  std::size_t drawn = 0, found = 0, alike = 0, true_loops = 0, true_lost = 0, runs = 0, exact = 0;
  double worst_off = 0.0;
};

template <class F>
void try_seed(const Set& set, const Graph& clean, const Graph& solved, std::uint64_t seed,
              const Table& table, Tally& tally) {
  Graph graph = clean;
  const std::set<std::size_t> added = add_false_loops<F>(graph, solved,
                                                         {.count = set.false_loops,
                                                          .in_groups = (set.false_loops + 2) / 3,
                                                          .between_robots = set.between_robots,
                                                          .seed = seed});
  Graph plain = graph;
  optimize(plain, kOptions);
  const Gated gated = run_gate(graph);
  const bool usable = gated.solution.summary.usable();
  const std::set<std::size_t> missed = without(added, gated.left_out);
  const std::size_t lost = without(gated.left_out, added).size();
  std::size_t alike = 0;
  if constexpr (std::is_same_v<F, BetweenSe3>)
    alike = indistinguishable(graph, solved, missed, gated.solution.noise_scale).size();
  const double extent = extent_m(solved);
  const double off = trajectory_error_m(solved, gated.graph) / extent;
  const double chi2 = gated.solution.summary.final_chi2;
  const std::size_t true_loops = gated.solution.loops - added.size();
  tally.drawn += added.size();
  tally.found += added.size() - missed.size();
  tally.alike += alike;
  tally.true_loops += true_loops;
  tally.true_lost += lost;
  ++tally.runs;
  tally.exact += usable && missed.empty() && lost == 0;
  tally.worst_off = std::max(tally.worst_off, off);
  table.row({set.name, std::to_string(seed), of(added.size() - missed.size(), added.size()),
             std::to_string(alike), of(lost, true_loops), usable ? number_text(chi2) : "none",
             percent(off), percent(trajectory_error_m(solved, plain) / extent),
             time_text(gated.seconds)});
}

void try_false_loops(const Set& set, int rounds, std::uint64_t seed) {
  std::optional<Graph> clean = load_files(set.name, set.paths);
  if (!clean) return;
  Graph solved = *clean;
  const SolveSummary summary = optimize(solved, kOptions);
  std::printf("\n%s, %zu false loops; without them chi2 %.2f, extent %.1f m\n\n", set.name.c_str(),
              set.false_loops, summary.final_chi2, extent_m(solved));
  const Table table({"set", "seed", "false found", "missed, alike", "true left out", "chi2", "off",
                     "off without gate", "time"});
  Tally tally;
  for (int round = 0; round < rounds; ++round, ++seed) {
    if (clean->find_batch<BetweenSe3>() != nullptr)
      try_seed<BetweenSe3>(set, *clean, solved, seed, table, tally);
    else
      try_seed<BetweenSe2>(set, *clean, solved, seed, table, tally);
  }
  const double n = static_cast<double>(std::max<std::size_t>(tally.drawn, 1));
  std::printf(
      "\n%s + %zu: false recall %.3f (%.3f of those that can be told), true left out %.4f, "
      "worst %.1f %% off, exact %zu of %zu\n",
      set.name.c_str(), set.false_loops, static_cast<double>(tally.found) / n,
      static_cast<double>(tally.found) / std::max(n - static_cast<double>(tally.alike), 1.0),
      static_cast<double>(tally.true_lost) / static_cast<double>(tally.true_loops),
      100.0 * tally.worst_off, tally.exact, tally.runs);
}

void try_clean(const Set& set, const Table& table) {
  std::optional<Graph> graph = load_files(set.name, set.paths);
  if (!graph) return;
  const Gated gated = run_gate(*graph);
  const double optimum = optimize(*graph, kOptions).final_chi2;
  table.row({set.name, std::to_string(gated.solution.loops), std::to_string(gated.left_out.size()),
             number_text(optimum), number_text(gated.solution.summary.final_chi2),
             number_text(gated.solution.noise_scale, 5), time_text(gated.seconds)});
}

void try_truth(const Set& set, const std::string& truth_path, bool has_stamps, const Table& table) {
  std::optional<Graph> graph = load_files(set.name, set.paths);
  const std::optional<Graph> truth = load_files(set.name, {truth_path});
  if (!graph || !truth) return;
  const Gated gated = run_gate(*graph);
  optimize(*graph, kOptions);
  const auto score = has_stamps ? trajectory_error_m : distance_to_path_m;
  const auto metres = [&](const Graph& estimate) {
    return number_text(has_stamps ? score(*truth, estimate) : score(estimate, *truth)) + " m";
  };
  table.row({set.name, std::to_string(gated.solution.loops), std::to_string(gated.left_out.size()),
             metres(*graph), metres(gated.graph), time_text(gated.seconds)});
}

void try_pairs(const Set& set, const Table& table) {
  std::optional<Graph> graph = load_files(set.name, set.paths);
  if (!graph) return;
  const Gated gated = run_gate(*graph);
  const double scale = gated.solution.noise_scale;
  for (const bool gate : {false, true}) {
    const PairScore score =
        score_pairs(*graph, gate ? gated.left_out : std::set<std::size_t>{}, scale);
    table.row({set.name, gate ? "kept" : "all",
               std::to_string(gated.solution.loops - (gate ? gated.left_out.size() : 0)),
               std::to_string(score.pairs), of(score.consistent_as_stated, score.pairs),
               of(score.consistent, score.pairs), number_text(scale, 4)});
  }
}

void run(const Arguments& arguments, std::uint64_t seed) {
  const auto pose2 = [](const std::string& name) { return "graphs/pose2/" + name + ".g2o"; };
  const auto pose3 = [](const std::string& name) { return "graphs/pose3/" + name + ".g2o"; };
  const std::string outliers = "graphs/outliers/";
  std::vector<Set> sets;
  for (const std::size_t count : {5, 20, 50})
    sets.push_back({"argos_clean", four_robots("argos_clean"), count, true});
  for (const char* name : {"manhattan", "city10000", "intel", "CSAIL", "kitti_00", "M3500a"})
    sets.push_back({name, {pose2(name)}, 100});
  for (const char* name : {"sphere2500", "parking-garage"})
    sets.push_back({name, {pose3(name)}, 100});
  const std::string ring = outliers + "vertigo_ringCity/";
  sets.push_back({"ringCity", {ring + "originalDataset/ringCity.g2o"}, 100});

  std::puts("\n### As they are\n");
  const Table clean({"set", "loops", "left out", "chi2, plain", "gated", "noise scale", "time"});
  for (std::size_t i = 2; i < sets.size(); ++i)
    if (arguments.wants(sets[i].name)) try_clean(sets[i], clean);

  std::puts("\n### Against the truth\n");
  const Table truth({"set", "loops", "left out", "off, plain", "gated", "time"});
  for (const char* name : {"B25b_0.000", "B25b_0.200", "B25b_0.500"})
    if (arguments.wants(name))
      try_truth({name, {outliers + "bicocca/" + name + ".g2o"}, 0},
                outliers + "bicocca/Bicocca25b_GT_GPS.g2o", false, truth);
  if (arguments.wants("ringCity"))
    try_truth(sets.back(), ring + "groundTruth/ringCity.g2o", true, truth);

  std::puts("\n### Pairs of loops between robots that are consistent (chi-square, 99 %)\n");
  const Table pairs({"set", "", "loops", "pairs", "as stated", "scaled", "noise scale"});
  for (const char* name : {"argos_clean", "argos_spoiled"})
    if (arguments.wants(name)) try_pairs({name, four_robots(name), 0, true}, pairs);

  std::puts(
      "\n### With false loops\n\nEach is what was measured between two poses, said of two "
      "others where it is 3 m off or more; a third in groups of four keyframes in a row.\n"
      "alike: the true map's covariance cannot tell it from a true one (99 %).\n"
      "off: distance of the poses from the optimum without false loops, over its extent.");
  for (const Set& set : sets)
    if (arguments.wants(set.name))
      try_false_loops(set, set.between_robots ? 4 * arguments.rounds : arguments.rounds, seed);
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  const char* given = std::getenv("CAIRN_SEED");
  const std::uint64_t seed =
      given ? std::strtoull(given, nullptr, 10) : std::random_device{}() % 1'000'000;
  std::printf("## The gate and false loop closures, CAIRN_SEED=%llu\n",
              static_cast<unsigned long long>(seed));
  run(parse_arguments(argc, argv), seed);
}
