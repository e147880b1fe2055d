// SPDX-License-Identifier: BSD-3-Clause
// Solver against solver, from the same start, one thread. On CHOLMOD, as Ceres is: how far are we
// from what the factorizations alone cost? With our own factorization: how far from Ceres, and
// where does our time go?
#include <cmath>
#include <cstdio>

#include "benchmarks/support/cairn_run.hpp"
#include "benchmarks/support/ceres_rival.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/plain_cholmod.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/linear/single_thread_blas.hpp"
#include "cairn/solver/normal_equations.hpp"

namespace cairn::bench {
namespace {

/// What CHOLMOD needs for our matrix in our order, s.
struct CholmodCosts {
  double ordering_s, analysis_s, factorize_and_solve_s;
};

CholmodCosts measure_cholmod(const Graph& start) {
  const Problem problem(start);
  const UnknownLayout layout(problem);
  NormalEquations equations(problem, layout);
  ThreadPool pool(1);
  equations.linearize({.values = start.values()}, pool);
  CholmodCosts costs{};
  costs.ordering_s = seconds_per_call([&] { (void)find_elimination(layout.blocks); });
  const std::unique_ptr<LinearSolver> solver = make_plain_cholmod();
  costs.analysis_s =
      seconds_per_call([&] { solver->analyze(equations.pattern(), layout.elimination); });
  Eigen::VectorXd x(equations.pattern().scalar_size());
  if (!solver->factorize(equations.values())) return {NAN, NAN, NAN};  // the first one allocates
  costs.factorize_and_solve_s = seconds_per_call([&] {
    if (solver->factorize(equations.values())) solver->solve(equations.gradient().data(), x.data());
  });
  return costs;
}

/// Medians over the rounds of one graph.
struct Comparison {
  CairnRun on_cholmod;
  CairnRun ours;  ///< to_optimum_s and its parts
  CholmodCosts cholmod;
  CeresRun tuned;
};

double median_of(const std::vector<CairnRun>& runs, double CairnRun::*part) {
  std::vector<double> samples;
  for (const CairnRun& run : runs) samples.push_back(run.*part);
  return median(samples);
}

double median_of(const std::vector<CholmodCosts>& runs, double CholmodCosts::*part) {
  std::vector<double> samples;
  for (const CholmodCosts& run : runs) samples.push_back(run.*part);
  return median(samples);
}

Comparison compare(const Graph& start, double target, int rounds) {
  CeresPoseGraph rival(start);
  std::vector<CairnRun> on_cholmod, ours;
  std::vector<CholmodCosts> cholmod;
  CeresRun tuned;
  const std::function<double()> contenders[] = {
      [&] {
        ours.push_back(run_cairn(start, target));
        return ours.back().to_optimum_s.value_or(NAN);
      },
      [&] {
        on_cholmod.push_back(run_cairn(start, target, {.linear = LinearBackend::kCholmod}));
        return on_cholmod.back().to_optimum_s.value_or(NAN);
      },
      [&] {
        cholmod.push_back(measure_cholmod(start));
        return 0.0;
      },
      [&] {
        tuned = rival.run(CeresSettings::kTuned, target);
        return tuned.to_optimum_s.value_or(NAN);
      },
  };
  const std::vector<double> seconds = interleaved_medians(rounds, contenders);
  Comparison result{on_cholmod.back(), ours.back(), {}, tuned};
  result.ours.to_optimum_s = seconds[0];
  result.on_cholmod.to_optimum_s = seconds[1];
  result.tuned.to_optimum_s = seconds[3];
  for (double CairnRun::*part :
       {&CairnRun::setup_s, &CairnRun::linearize_s, &CairnRun::factorize_s, &CairnRun::solve_s}) {
    result.ours.*part = median_of(ours, part);
  }
  for (double CholmodCosts::*part : {&CholmodCosts::ordering_s, &CholmodCosts::analysis_s,
                                     &CholmodCosts::factorize_and_solve_s}) {
    result.cholmod.*part = median_of(cholmod, part);
  }
  return result;
}

// Ceres as it comes needs far longer; three rounds tell enough.
double default_seconds(const Graph& start, double target) {
  CeresPoseGraph rival(start);
  const std::function<double()> contender[] = {
      [&] { return rival.run(CeresSettings::kDefaults, target).to_optimum_s.value_or(NAN); }};
  return interleaved_medians(3, contender).front();
}

std::vector<std::string> main_row(const BenchmarkGraph& which, const Graph& start,
                                  const Comparison& c, double defaults_s) {
  const double ours_s = *c.ours.to_optimum_s, on_cholmod_s = *c.on_cholmod.to_optimum_s;
  const double ceres_s = *c.tuned.to_optimum_s;
  const double analysis_s = c.cholmod.ordering_s + c.cholmod.analysis_s;
  const double limit_s = c.on_cholmod.iterations * c.cholmod.factorize_and_solve_s + analysis_s;
  return {std::string(which.name) + (which.chordal_start ? " (chordal start)" : ""),
          std::to_string(start.variables().size()) + " / " + std::to_string(start.factor_count()),
          std::to_string(c.ours.iterations),
          time_text(c.cholmod.factorize_and_solve_s),
          time_text(analysis_s),
          time_text(on_cholmod_s),
          number_text(limit_s / on_cholmod_s),
          time_text(ours_s),
          number_text(limit_s / ours_s),
          std::to_string(c.tuned.iterations),
          time_text(ceres_s),
          ratio_text(ceres_s / on_cholmod_s),
          ratio_text(ceres_s / ours_s),
          time_text(defaults_s)};
}

std::vector<std::string> breakdown_row(const BenchmarkGraph& which, const Comparison& c) {
  return {std::string(which.name),         time_text(*c.ours.to_optimum_s),
          time_text(c.cholmod.ordering_s), time_text(c.ours.setup_s - c.cholmod.ordering_s),
          time_text(c.ours.linearize_s),   time_text(c.ours.factorize_s),
          time_text(c.ours.solve_s),       time_text(c.ours.rest_s())};
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  const Arguments arguments = parse_arguments(argc, argv);
  keep_freed_memory();
  const cairn::SingleThreadBlas single_thread;  // the cure for both sides
  std::printf(
      "## Solver against solver: same start, one thread, median of %d interleaved runs\n\n"
      "Times to the first iterate within 1e-6 of the optimum, structure included. k: our "
      "iterations; F: one CHOLMOD factorization and solve, S: one analysis (ordering + symbolic), "
      "of our matrix in our order. Ceres runs on CHOLMOD.\n\n",
      arguments.rounds);
  const Table table({"graph", "poses / edges", "k", "F", "S", "Cairn on CHOLMOD", "(kF+S) / that",
                     "Cairn", "(kF+S) / that", "Ceres iterations", "Ceres tuned",
                     "Ceres / Cairn on CHOLMOD", "Ceres / Cairn", "Ceres defaults"});
  std::vector<std::vector<std::string>> breakdown;
  for (const BenchmarkGraph& which : benchmark_graphs()) {
    if (!arguments.wants(which.name)) continue;
    const std::optional<cairn::Graph> graph = load(which);
    if (!graph) continue;
    const cairn::Graph start = common_start(which, *graph);
    const double target = target_of(find_optimum(start));
    const Comparison comparison = compare(start, target, arguments.rounds);
    table.row(main_row(which, start, comparison, default_seconds(start, target)));
    breakdown.push_back(breakdown_row(which, comparison));
  }
  std::puts(
      "\nWhere Cairn's time goes (structure: what is not ordering, and the first "
      "linearization):\n");
  const Table parts({"graph", "Cairn", "ordering", "structure", "linearize", "factorize", "solve",
                     "rest (retract, bookkeeping)"});
  for (const auto& row : breakdown) parts.row(row);
}
