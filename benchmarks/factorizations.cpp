// SPDX-License-Identifier: BSD-3-Clause
// One matrix, two factorizations: our fronts against CHOLMOD, same matrix, same order, one thread.
#include <cmath>

#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/plain_cholmod.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/linear/single_thread_blas.hpp"
#include "cairn/solver/normal_equations.hpp"

namespace cairn::bench {
namespace {

struct Costs {
  double analyze_s, factorize_s, solve_s;
};

// Multiplications and additions of a factorization without zeros.
double operations(const NormalEquations& equations, const Elimination& elimination) {
  double sum = 0.0;
  for (int j = 0; j < equations.pattern().size(); ++j) {
    const double d = equations.pattern().dimension[j], rows = d * elimination.count[j];
    sum += d * rows * rows;
  }
  return sum;
}

Costs measure(LinearSolver& solver, const NormalEquations& equations,
              const Elimination& elimination) {
  Costs costs{};
  const Stopwatch watch;
  solver.analyze(equations.pattern(), elimination);
  costs.analyze_s = watch.seconds();
  Eigen::VectorXd x(equations.pattern().scalar_size());
  bool regular = solver.factorize(equations.values());  // the first one touches fresh memory
  costs.factorize_s =
      seconds_per_call([&] { regular = solver.factorize(equations.values()) && regular; });
  costs.solve_s = seconds_per_call([&] { solver.solve(equations.gradient().data(), x.data()); });
  return regular ? costs : Costs{NAN, NAN, NAN};
}

void compare(const Table& table, const BenchmarkGraph& which, const Graph& start, int rounds) {
  const Problem problem(start);
  const UnknownLayout layout(problem);
  NormalEquations equations(problem, layout);
  ThreadPool pool(1);
  equations.linearize({.values = start.values()}, pool);
  std::vector<double> samples[2][3];
  for (int round = 0; round <= rounds; ++round) {
    for (const int own : {0, 1}) {
      const auto solver = own == 1 ? make_multifrontal_solver() : make_plain_cholmod();
      const Costs costs = measure(*solver, equations, layout.elimination);
      if (round == 0) continue;
      samples[own][0].push_back(costs.analyze_s);
      samples[own][1].push_back(costs.factorize_s);
      samples[own][2].push_back(costs.solve_s);
    }
  }
  const double work = operations(equations, layout.elimination);
  std::vector<std::string> cells{std::string(which.name),
                                 std::to_string(equations.pattern().scalar_size()),
                                 number_text(work * 1e-9, 3)};
  for (const auto& parts : samples) {
    for (const auto& part : parts) cells.push_back(time_text(median(part)));
    cells.push_back(number_text(work / median(parts[1]) * 1e-9, 1));
  }
  for (const int part : {1, 2})
    cells.push_back(ratio_text(median(samples[0][part]) / median(samples[1][part])));
  table.row(cells);
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  const Arguments arguments = parse_arguments(argc, argv);
  const cairn::SingleThreadBlas single_thread;
  std::printf("## Factorizations: one matrix, one order, one thread, median of %d\n\n",
              arguments.rounds);
  const Table table({"graph", "unknowns", "GFlop", "CHOLMOD analyze", "factorize", "solve",
                     "GFlop/s", "Cairn analyze", "factorize", "solve", "GFlop/s",
                     "factorize, CHOLMOD / Cairn", "solve, CHOLMOD / Cairn"});
  for (const BenchmarkGraph& which : benchmark_graphs()) {
    if (!arguments.wants(which.name)) continue;
    if (const std::optional<cairn::Graph> graph = load(which))
      compare(table, which, common_start(which, *graph), arguments.rounds);
  }
}
