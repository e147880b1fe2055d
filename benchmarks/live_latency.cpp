// SPDX-License-Identifier: BSD-3-Clause
// How soon after a loop closure do robots have the new poses, while 500 keyframes a second come in?
// One robot in a simulated city, the real daemon, DDS on loopback. A closure is timed from its
// submission until the client has poses of a solve that has seen it. The map grows while it is
// measured, so each run begins anew and lasts as long as the map stays about as large.
// Usage: bench_live_latency [--closures N] [--poses N]: so many closures (200) where there are
// 3,500 and 10,000 poses, a tenth elsewhere; this size only. The data folder is made in
// DAEMON_FOLDER (default: here).
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/support/daemon_run.hpp"
#include "benchmarks/support/receipt_collector.hpp"
#include "cairn/replay/graph_transactions.hpp"
#include "clients/client/client.hpp"
#include "datasets/simulate.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double kKeyframesPerSecond = 500.0;

// Transactions of one drive; the loops of those behind `known` apart.
struct Drive {
  std::vector<Transaction> steps;
  std::map<std::size_t, Transaction> closures;  ///< by the step they come with
};

Drive make_drive(int known, int more) {
  SimulationOptions options;
  options.world = World::kCity;
  options.poses = known + more;
  const Result<SimulatedGraph> simulated = simulate(options);
  if (!simulated) {
    std::fprintf(stderr, "%s\n", simulated.error().to_string().c_str());
    std::exit(1);
  }
  Drive drive;
  drive.steps = graph_transactions(simulated->graph, [](VariableId id) {
    return NodeId{{"robot", 1}, id.value};
  });
  for (auto i = static_cast<std::size_t>(known); i < drive.steps.size(); ++i) {
    std::vector<NewFactor>& factors = drive.steps[i].factors;
    const auto loop = std::stable_partition(factors.begin(), factors.end(), [](const NewFactor& f) {
      return f.kind == FactorKind::kOdometry;
    });
    if (loop != factors.end()) drive.closures[i].factors.push_back(*loop);
    factors.erase(loop, factors.end());
  }
  return drive;
}

// When the client had poses of a solve that has seen a record.
class SolvedTimes {
 public:
  void add(std::uint64_t record) {
    const std::lock_guard lock(mutex_);
    times_.emplace(record, Clock::now());
  }
  std::optional<Clock::time_point> of(std::uint64_t record) {
    const std::lock_guard lock(mutex_);
    const auto at = times_.lower_bound(record);
    return at == times_.end() ? std::nullopt : std::optional(at->second);
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, Clock::time_point> times_;
};

struct Latencies {
  std::vector<double> receipt_s, growth_s, closure_s;
};

// Sends the rest of the drive at the pace, and one closure a second.
void measure(Client& client, const Drive& drive, std::size_t known, int seconds,
             Latencies& latencies) {
  SolvedTimes solved, shown;
  client.on_poses([&](const PoseUpdate& update) {
    shown.add(update.revisions.graph.number);
    solved.add(update.revisions.solved.number);
  });
  std::vector<std::pair<std::uint64_t, Clock::time_point>> closures;
  std::vector<std::pair<std::uint64_t, Clock::time_point>> receipts;
  bench::ReceiptCollector collector;
  const auto submit = [&](const Transaction& transaction, bool closure) {
    const auto at = Clock::now();
    Result<Submission> taken = client.submit_async(transaction);
    if (!taken) std::exit(1);
    collector.add(std::move(*taken), [&, at, closure](const Result<Receipt>& receipt) {
      const auto now = Clock::now();
      if (!receipt || receipt->refusal) std::exit(1);
      latencies.receipt_s.push_back(std::chrono::duration<double>(now - at).count());
      receipts.emplace_back(receipt->revision.number, now);
      if (closure) closures.emplace_back(receipt->revision.number, at);
    });
  };
  const auto start = Clock::now();
  auto next_closure = start + 500ms;
  const Transaction* newest = nullptr;
  for (std::size_t i = known; i < drive.steps.size(); ++i) {
    const std::chrono::duration<double> due(static_cast<double>(i - known) / kKeyframesPerSecond);
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(due));
    if (due.count() > seconds) break;
    submit(drive.steps[i], false);
    if (const auto closure = drive.closures.find(i); closure != drive.closures.end())
      newest = &closure->second;
    if (newest != nullptr && Clock::now() >= next_closure) {
      submit(*newest, true);
      newest = nullptr;
      next_closure += 1s;
    }
  }
  collector.finish();
  for (const auto& [record, at] : closures) {
    for (int i = 0; i < 10'000 && !solved.of(record); ++i) std::this_thread::sleep_for(1ms);
    if (!solved.of(record)) std::exit(1);
    latencies.closure_s.push_back(std::chrono::duration<double>(*solved.of(record) - at).count());
  }
  client.on_poses({});  // it refers to what ends here
  for (const auto& [record, at] : receipts) {
    if (const auto when = shown.of(record))
      latencies.growth_s.push_back(
          std::max(0.0, std::chrono::duration<double>(*when - at).count()));
  }
}

void run(int known, int runs, int seconds) {
  const Drive drive = make_drive(known, static_cast<int>(kKeyframesPerSecond) * (seconds + 1));
  Latencies latencies;
  for (int i = 0; i < runs; ++i) {
    const auto folder = bench::fresh_folder("latency-benchmark");
    const std::uint32_t domain = test::own_domain();
    test::Process daemon(
        {CAIRND_BINARY, "--data", (folder / "data").string(), "--domain", std::to_string(domain)});
    Result<Client> client = Client::connect(
        {.domain = domain, .source = "robot", .robot = "robot", .spool = folder / "spool"});
    if (!client) std::exit(1);
    std::optional<Submission> last;
    for (int k = 0; k < known; ++k) {
      Result<Submission> taken = client->submit_async(drive.steps[k]);
      if (!taken) std::exit(1);
      last = std::move(*taken);
    }
    if (!last->wait(120s) || !client->command("settle", 120s)) std::exit(1);
    measure(*client, drive, static_cast<std::size_t>(known), seconds, latencies);
    daemon.end(SIGKILL);
    std::filesystem::remove_all(folder);
  }
  using bench::percentile_ms;
  std::printf("| %d to %d | %zu | %.2f | %.2f | %.1f | %.1f | %zu | %.0f | %.0f | %.0f |\n", known,
              known + static_cast<int>(kKeyframesPerSecond) * seconds, latencies.receipt_s.size(),
              percentile_ms(latencies.receipt_s, 0.5), percentile_ms(latencies.receipt_s, 0.99),
              percentile_ms(latencies.growth_s, 0.5), percentile_ms(latencies.growth_s, 0.99),
              latencies.closure_s.size(), percentile_ms(latencies.closure_s, 0.5),
              percentile_ms(latencies.closure_s, 0.99), percentile_ms(latencies.closure_s, 1.0));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int closures = 200, only = 0;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--closures") == 0) closures = std::atoi(argv[i + 1]);
    if (std::strcmp(argv[i], "--poses") == 0) only = std::atoi(argv[i + 1]);
  }
  const auto run_some = [&](int poses, int wanted, int seconds) {
    if (only == 0 || only == poses)
      run(poses, std::max(1, (wanted + seconds - 1) / seconds), seconds);
  };
  std::printf(
      "## From a loop closure to new poses, 500 keyframes and one closure a second\n\n"
      "| poses | receipts | p50, ms | p99, ms | growth shown after its receipt, p50, ms | p99, ms "
      "| closures | p50, ms | p99, ms | most, ms |\n|---|---|---|---|---|---|---|---|---|---|\n");
  run_some(1'000, closures / 10, 4);
  run_some(3'500, closures, 4);
  run_some(10'000, closures, 10);
  run_some(30'000, closures / 10, 20);
  run_some(100'000, closures / 10, 20);
  return 0;
}
