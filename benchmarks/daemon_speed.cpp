// SPDX-License-Identifier: BSD-3-Clause
// How fast does the real daemon take transactions over DDS on loopback? Four sources, counted at
// the clients on receipts. Usage: bench_daemon_speed [--seconds N] [--rate PER_SECOND]; the data
// folder is made in DAEMON_FOLDER (default: here).
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/support/daemon_run.hpp"
#include "benchmarks/support/receipt_collector.hpp"
#include "cairn/core/stopwatch.hpp"
#include "cairn/graph/pose_graph.hpp"
#include "clients/client/client.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/process_usage.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cairn;
using bench::fdatasync_p50_ms;
using bench::percentile_ms;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kSources = 4;

// A keyframe every metre, tied to the one before.
Transaction keyframe(const std::string& robot, std::uint64_t i) {
  Transaction step;
  const NodeId pose{{robot, 1}, i};
  step.variables.push_back({pose, VariableType::kPose2, {static_cast<double>(i), 0.0, 0.0}, 0, {}});
  if (i == 0) return step;
  NewFactor odometry;
  odometry.type = FactorType{1};
  odometry.kind = FactorKind::kOdometry;
  odometry.nodes = {{pose.frame, i - 1}, pose};
  odometry.numbers = {1.0, 0.0, 0.0, 100.0, 0.0, 0.0, 100.0, 0.0, 400.0};
  step.factors.push_back(odometry);
  return step;
}

// Says something about a factor that is there: the graph does not grow.
Transaction toggle(const TransactionKey& factor, std::uint64_t i) {
  Transaction step;
  step.edits.push_back({{factor, 0}, i % 2 == 0 ? FactorChange::kDisable : FactorChange::kEnable});
  return step;
}

// A client and what it sends, by the number of the transaction.
struct Robot {
  Client client;
  std::function<Transaction(std::uint64_t)> make;
};

struct Pace {
  double rate = 0.0;  ///< per second; 0: as fast as the window lets it
  double seconds = 1e9;
  std::uint64_t most = ~std::uint64_t{0};
};

struct Load {
  std::vector<double> latencies_s;
  std::uint64_t refused = 0;
};

// Submits, and times each receipt.
Load drive(Robot& robot, const Pace& pace) {
  Load load;
  bench::ReceiptCollector collector;
  const auto start = Clock::now();
  const std::uint64_t first = robot.client.next_sequence() - 1;
  for (std::uint64_t i = 0; i < pace.most; ++i) {
    if (pace.rate > 0.0) {
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(static_cast<double>(i) / pace.rate)));
    }
    if (std::chrono::duration<double>(Clock::now() - start).count() > pace.seconds) break;
    const auto at = Clock::now();
    Result<Submission> taken = robot.client.submit_async(robot.make(first + i));
    if (!taken) {
      std::fprintf(stderr, "%s\n", taken.error().to_string().c_str());
      std::exit(1);
    }
    collector.add(std::move(*taken), [&load, at](const Result<Receipt>& receipt) {
      if (!receipt || receipt->refusal)
        ++load.refused;
      else
        load.latencies_s.push_back(std::chrono::duration<double>(Clock::now() - at).count());
    });
  }
  collector.finish();
  return load;
}

// Each at this pace.
Load drive_all(std::vector<Robot>& robots, const Pace& pace) {
  std::vector<Load> loads(robots.size());
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < robots.size(); ++k)
    threads.emplace_back([&, k] { loads[k] = drive(robots[k], pace); });
  for (std::thread& thread : threads) thread.join();
  Load all;
  for (Load& load : loads) {
    all.latencies_s.insert(all.latencies_s.end(), load.latencies_s.begin(), load.latencies_s.end());
    all.refused += load.refused;
  }
  return all;
}

void report(const char* what, Load load, double seconds, pid_t daemon) {
  std::printf("| %s | %zu | %llu | %.0f | %.2f | %.2f | %.0f | %.0f |\n", what,
              load.latencies_s.size(), static_cast<unsigned long long>(load.refused),
              static_cast<double>(load.latencies_s.size()) / seconds,
              percentile_ms(load.latencies_s, 0.5), percentile_ms(load.latencies_s, 0.99),
              test::resident_mb(daemon), test::resident_mb(getpid()));
  std::fflush(stdout);
}

// Until a client that comes now has so many poses, s.
double late_joiner_seconds(std::uint32_t domain, std::size_t poses) {
  std::mutex mutex;
  std::condition_variable wake;
  std::map<std::pair<OdometryFrame, std::uint32_t>, std::size_t> chunks;
  std::size_t count = 0;
  Clock::time_point matched{}, complete{};
  Result<Client> client = Client::connect({.domain = domain});
  if (!client) return NAN;
  client->on_status([&](const Status&) {
    const std::lock_guard lock(mutex);
    if (matched == Clock::time_point{}) matched = Clock::now();
  });
  client->on_poses([&](const PoseUpdate& update) {
    const std::lock_guard lock(mutex);
    if (matched == Clock::time_point{}) matched = Clock::now();
    for (const PoseChunk& chunk : update.chunks) {
      std::size_t& known = chunks[{chunk.frame, chunk.chunk}];
      count += chunk.poses.size() - known;
      known = chunk.poses.size();
    }
    if (count >= poses && complete == Clock::time_point{}) complete = Clock::now();
    wake.notify_all();
  });
  std::unique_lock lock(mutex);
  if (!wake.wait_for(lock, 30s, [&] { return count >= poses; })) return NAN;
  return std::chrono::duration<double>(complete - matched).count();
}

// Of a copy of a map with so many poses.
double snapshot_us(std::size_t poses) {
  PoseGraph map;
  for (std::size_t i = 0; i < poses; ++i) {
    map.nodes.push_back({{{"robot", 1}, i}, i + 1, VariableType::kPose2, 0, {0.0, 0.0, 0.0}, {}});
    map.estimates.push_back({});
    map.factors.push_back({});
  }
  std::vector<double> seconds;
  for (int i = 0; i < 101; ++i) {
    const Stopwatch watch;
    const PoseGraph copy = map;
    seconds.push_back(watch.seconds());
    if (copy.nodes.size() != poses) std::abort();
  }
  return 1e3 * percentile_ms(seconds, 0.5);
}

std::vector<std::string> daemon_command(const fs::path& folder, std::uint32_t domain) {
  return {CAIRND_BINARY, "--data", (folder / "data").string(), "--domain", std::to_string(domain)};
}

// How many variables the daemon's first status speaks of; each came by a transaction of its own.
std::uint64_t variables_when_serving(std::uint32_t domain) {
  std::mutex mutex;
  std::condition_variable wake;
  std::optional<Status> first;
  Result<Client> client = Client::connect({.domain = domain});
  if (!client) return 0;
  client->on_status([&](const Status& status) {
    const std::lock_guard lock(mutex);
    if (!first && status.state == DaemonState::kServing) first = status;
    wake.notify_all();
  });
  std::unique_lock lock(mutex);
  wake.wait_for(lock, 120s, [&] { return first.has_value(); });
  return first ? first->variables : 0;
}

int run(double seconds, double rate) {
  const fs::path folder = bench::fresh_folder("daemon-benchmark");
  const double sync_ms = fdatasync_p50_ms(folder);
  const std::uint32_t domain = test::own_domain();
  test::Process daemon(daemon_command(folder, domain));
  std::vector<Robot> robots;
  std::vector<TransactionKey> factors;
  for (int k = 0; k < kSources; ++k) {
    const std::string robot = "robot" + std::to_string(k);
    Result<Client> client = Client::connect(
        {.domain = domain, .source = robot, .robot = robot, .spool = folder / ("spool-" + robot)});
    if (!client) {
      std::fprintf(stderr, "%s\n", client.error().to_string().c_str());
      return 1;
    }
    if (!client->submit(keyframe(robot, 0), 10s)) return 1;
    const Result<Receipt> second = client->submit(keyframe(robot, 1), 10s);
    if (!second) return 1;
    factors.push_back(second->key);
    robots.push_back({std::move(*client), [robot](std::uint64_t i) { return keyframe(robot, i); }});
  }
  std::printf(
      "## Daemon speed on loopback, %d sources, one process each side\n\n"
      "fdatasync of 600 bytes on this disk: p50 %.2f ms\n\n"
      "| load | receipts | refused | per second | receipt p50, ms | p99, ms | daemon MB | clients "
      "MB "
      "|\n|---|---|---|---|---|---|---|---|\n",
      kSources, sync_ms);
  report("as fast as it goes", drive_all(robots, {.seconds = 10.0}), 10.0, daemon.id());
  const std::string paced = std::to_string(static_cast<int>(rate)) + "/s";
  report(paced.c_str(), drive_all(robots, {rate / kSources, seconds}), seconds, daemon.id());
  for (int k = 0; k < kSources; ++k)
    robots[k].make = [factor = factors[k]](std::uint64_t i) { return toggle(factor, i); };
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Stopwatch watch;
    Load edits = drive_all(robots, {.most = 250'000 / kSources});
    report("250,000 edits of a factor", std::move(edits), watch.seconds(), daemon.id());
  }
  const Result<std::string> settled = robots[0].client.command("settle", 600s);
  std::printf("\nsettle: %s\n", (settled ? *settled : settled.error().to_string()).c_str());
  std::this_thread::sleep_for(5s);  // it stores a snapshot
  const double before = test::cpu_seconds(daemon.id());
  std::this_thread::sleep_for(10s);
  std::printf("idle: %.2f %% of one core, %.0f MB\n",
              10.0 * (test::cpu_seconds(daemon.id()) - before), test::resident_mb(daemon.id()));
  std::printf("late joiner: 10,000 poses %.0f ms after the first message\n",
              1e3 * late_joiner_seconds(domain, 10'000));
  for (const std::size_t poses : {10'000, 1'000'000})
    std::printf("taking a snapshot of %zu poses: %.1f us\n", poses, snapshot_us(poses));
  const Stopwatch ending;
  const int exit_code = daemon.end(SIGTERM).exit_code;
  std::printf("SIGTERM: exit code %d after %.2f s\n", exit_code, ending.seconds());
  robots.clear();
  for (const bool snapshot : {true, false}) {
    if (!snapshot) fs::remove_all(folder / "data" / "snapshots");
    const Stopwatch starting;
    test::Process again(daemon_command(folder, domain));
    const std::uint64_t variables = variables_when_serving(domain);
    std::printf("start with %llu transactions, %s snapshot: serves after %.2f s\n",
                static_cast<unsigned long long>(variables), snapshot ? "with a" : "without",
                starting.seconds());
    again.end(SIGKILL);
  }
  fs::remove_all(folder);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 60.0, rate = 5000.0;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seconds") == 0) seconds = std::strtod(argv[i + 1], nullptr);
    if (std::strcmp(argv[i], "--rate") == 0) rate = std::strtod(argv[i + 1], nullptr);
  }
  return run(seconds, rate);
}
