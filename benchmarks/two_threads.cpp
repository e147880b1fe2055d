// SPDX-License-Identifier: BSD-3-Clause
// What does a second thread bring? Linearization and assembly run on it, factorization does not.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <thread>

#include "benchmarks/support/cairn_run.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/solver/normal_equations.hpp"

namespace cairn::bench {
namespace {

// What both threads write goes to and fro: this takes four times as long where a virtual machine
// has its two cores far from each other, and decides what a second thread is worth on a small
// graph.
double line_round_trip_ns() {
  constexpr std::uint32_t kTrips = 100'000;
  std::atomic<std::uint32_t> line{0};
  std::jthread other([&] {
    for (std::uint32_t i = 0; i < kTrips; ++i) {
      while (line.load(std::memory_order_acquire) != 2 * i + 1) {
      }
      line.store(2 * i + 2, std::memory_order_release);
    }
  });
  const Stopwatch watch;
  for (std::uint32_t i = 0; i < kTrips; ++i) {
    line.store(2 * i + 1, std::memory_order_release);
    while (line.load(std::memory_order_acquire) != 2 * i + 2) {
    }
  }
  return watch.seconds() / kTrips * 1e9;
}

// Linearization and assembly alone, often enough that one wake-up of a thread does not decide.
double linearize_seconds(NormalEquations& equations, const Graph& graph, ThreadPool& pool) {
  constexpr int kRepetitions = 100;
  const Stopwatch watch;
  for (int i = 0; i < kRepetitions; ++i) equations.linearize({.values = graph.values()}, pool);
  return watch.seconds() / kRepetitions;
}

void compare(const BenchmarkGraph& which, const Graph& start, int rounds, const Table& table) {
  const Problem problem(start);
  const UnknownLayout layout(problem);
  NormalEquations equations(problem, layout);
  ThreadPool one(1), two(2);
  const double target = target_of(find_optimum(start));
  const std::function<double()> contenders[] = {
      [&] { return linearize_seconds(equations, start, one); },
      [&] { return linearize_seconds(equations, start, two); },
      [&] { return run_cairn(start, target, {.threads = 1}).to_optimum_s.value_or(NAN); },
      [&] { return run_cairn(start, target, {.threads = 2}).to_optimum_s.value_or(NAN); },
  };
  const std::vector<double> seconds = interleaved_medians(rounds, contenders);
  table.row({std::string(which.name), time_text(seconds[0]), time_text(seconds[1]),
             ratio_text(seconds[0] / seconds[1]), time_text(seconds[2]), time_text(seconds[3]),
             ratio_text(seconds[2] / seconds[3]),
             std::to_string(std::lround(line_round_trip_ns())) + " ns"});
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  const Arguments arguments = parse_arguments(argc, argv);
  std::printf("## Two threads against one, median of %d\n\n", arguments.rounds);
  const Table table({"graph", "linearize + assemble, 1", "2 threads", "faster", "whole run, 1",
                     "2 threads", "faster", "line, to and fro"});
  for (const BenchmarkGraph& which : benchmark_graphs()) {
    if (!arguments.wants(which.name)) continue;
    const std::optional<cairn::Graph> graph = load(which);
    if (graph) compare(which, common_start(which, *graph), arguments.rounds, table);
  }
}
