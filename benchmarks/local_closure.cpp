// SPDX-License-Identifier: BSD-3-Clause
// What does a loop closure over the last hundred poses cost, and how does that grow with the map?
// The real daemon with a simulated, settled city; closures one after the other, each timed from its
// submission until the client has poses of a solve that has seen it, while nothing else goes on.
// Usage: bench_local_closure [--closures N] [--chart FILE.svg] [POSES...]
#include <signal.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/support/daemon_run.hpp"
#include "benchmarks/support/line_chart.hpp"
#include "benchmarks/support/measure.hpp"
#include "cairn/core/stopwatch.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/replay/graph_transactions.hpp"
#include "clients/client/client.hpp"
#include "datasets/simulate.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/process_usage.hpp"

namespace {

using namespace cairn;
using namespace std::chrono_literals;

constexpr std::uint64_t kSpan = 100;

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

NodeId node(std::uint64_t i) { return {{"robot", 1}, i}; }

// Between the poses i and i - kSpan, as a scan matcher would measure it.
Transaction closure(const SimulatedGraph& city, std::uint64_t i, std::mt19937_64& random) {
  constexpr double kPosition_m = 0.05, kHeading_rad = 0.01;
  const std::vector<Se2>& truth = city.truth.pose2;
  std::uniform_real_distribution<double> noise(-1.0, 1.0);
  const Se2 error(kPosition_m * noise(random), kPosition_m * noise(random),
                  kHeading_rad * noise(random));
  const Se2 T = truth[i - kSpan].inverse() * truth[i] * error;
  const double position = 1.0 / (kPosition_m * kPosition_m);
  NewFactor loop;
  loop.type = FactorType{1};
  loop.kind = FactorKind::kLoop;
  loop.nodes = {node(i - kSpan), node(i)};
  loop.numbers = {T.x(),    T.y(), T.theta(),
                  position, 0.0,   0.0,
                  position, 0.0,   1.0 / (kHeading_rad * kHeading_rad)};
  Transaction transaction;
  transaction.factors.push_back(loop);
  return transaction;
}

void send_all(Client& client, const SimulatedGraph& city) {
  std::optional<Submission> last;
  for (Transaction& step :
       graph_transactions(city.graph, [](VariableId id) { return node(id.value); })) {
    Result<Submission> taken = client.submit_async(std::move(step));
    if (!taken) give_up(taken.error().to_string());
    last = std::move(*taken);
  }
  if (!last->wait(5min) || !client.command("settle", 5min)) give_up("the daemon is too slow");
}

struct Cost {
  std::vector<double> seconds, cpu_seconds;
  double moved = 0.0;  ///< poses, on average
};

// Of the last solves, live ones and those of a map that settles, as many as closures.
double poses_moved(const std::string& folder, std::size_t closures) {
  const auto journal = Journal::open(folder);
  if (!journal) give_up(journal.error().to_string());
  std::vector<double> moved;
  const auto walked = (*journal)->for_each(1, [&](const Record& record) -> Result<void> {
    const auto* solve = std::get_if<SolveRecord>(&record.body);
    const auto method =
        solve == nullptr ? std::nullopt : SolveSettings::parse(solve->settings).known();
    if (method) moved.push_back(static_cast<double>(solve->changed.size()));
    return {};
  });
  if (!walked || moved.size() < closures) give_up("there are not as many solves as closures");
  double sum = 0.0;
  for (std::size_t i = moved.size() - closures; i < moved.size(); ++i) sum += moved[i];
  return sum / static_cast<double>(closures);
}

Cost measure(std::size_t poses, std::size_t closures) {
  const Result<SimulatedGraph> city = simulate({.world = World::kCity, .poses = poses});
  if (!city) give_up(city.error().to_string());
  const auto folder = bench::fresh_folder("local-closure-benchmark");
  const std::uint32_t domain = test::own_domain();
  test::Process daemon(
      {CAIRND_BINARY, "--data", (folder / "data").string(), "--domain", std::to_string(domain)});
  Result<Client> client = Client::connect(
      {.domain = domain, .source = "robot", .robot = "robot", .spool = folder / "spool"});
  if (!client) give_up(client.error().to_string());
  client->on_poses([](const PoseUpdate&) {});
  send_all(*client, *city);
  std::mt19937_64 random(1);
  Cost cost;
  for (std::size_t k = 0; k < closures; ++k) {
    const Transaction loop = closure(*city, poses - 1 - k, random);
    const double cpu = test::cpu_seconds(daemon.id());
    const Stopwatch watch;
    const Result<Receipt> receipt = client->submit(loop, 10s);
    if (!receipt || receipt->refusal) give_up("a closure was refused");
    if (!client->wait_solved(receipt->revision, 60s)) give_up("a closure was not solved");
    cost.seconds.push_back(watch.seconds());
    cost.cpu_seconds.push_back(test::cpu_seconds(daemon.id()) - cpu);
    if (!client->command("settle", 5min)) give_up("the map does not settle");
  }
  client = Error{ErrorCode::kInternal, "ended"};
  if (daemon.end(SIGTERM).exit_code != 0) give_up("the daemon failed");
  cost.moved = poses_moved((folder / "data").string(), closures);
  std::filesystem::remove_all(folder);
  return cost;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t closures = 50;
  std::string chart_file;
  std::vector<std::size_t> sizes;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--closures") == 0 && i + 1 < argc)
      closures = std::strtoul(argv[++i], nullptr, 10);
    else if (std::strcmp(argv[i], "--chart") == 0 && i + 1 < argc)
      chart_file = argv[++i];
    else
      sizes.push_back(std::strtoul(argv[i], nullptr, 10));
  }
  if (sizes.empty()) sizes = {1'000, 3'500, 10'000, 30'000};
  for (const std::size_t poses : sizes)
    if (closures == 0 || poses < closures + kSpan)
      give_up("expected more poses than closures span");
  std::printf(
      "## A loop closure over the last %llu poses, against the size of the map\n\n"
      "| poses | closures | to new poses, p50, ms | p99, ms | the daemon's processor time, mean, "
      "ms "
      "| poses moved, mean |\n|---|---|---|---|---|---|\n",
      static_cast<unsigned long long>(kSpan));
  bench::LineChart chart{"A loop closure over the last 100 poses",
                         "poses in the map",
                         "ms",
                         {{"p99", {}}, {"p50", {}}, {"processor time", {}}}};
  std::vector<double> x, y;
  for (const std::size_t poses : sizes) {
    Cost cost = measure(poses, closures);
    double cpu_ms = 0.0;
    for (const double seconds : cost.cpu_seconds)
      cpu_ms += 1e3 * seconds / static_cast<double>(closures);
    const double p50 = bench::percentile_ms(cost.seconds, 0.5);
    const double p99 = bench::percentile_ms(cost.seconds, 0.99);
    std::printf("| %zu | %zu | %.1f | %.1f | %.0f | %.0f |\n", poses, closures, p50, p99, cpu_ms,
                cost.moved);
    std::fflush(stdout);
    const auto size = static_cast<double>(poses);
    chart.series[0].points.emplace_back(size, p99);
    chart.series[1].points.emplace_back(size, p50);
    chart.series[2].points.emplace_back(size, std::max(cpu_ms, 0.1));
    x.push_back(size), y.push_back(p50);
  }
  if (x.size() > 1) std::printf("\np50 grows as poses^%.2f.\n", bench::fitted_exponent(x, y));
  if (chart_file.empty()) return 0;
  if (auto drawn = bench::draw(chart, chart_file); !drawn) give_up(drawn.error().to_string());
  std::printf("\n![the same, drawn](%s)\n",
              std::filesystem::path(chart_file).filename().string().c_str());
  return 0;
}
