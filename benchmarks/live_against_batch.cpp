// SPDX-License-Identifier: BSD-3-Clause
// Is the live map as good as a batch solve? Graph files are replayed to the real daemon at a steady
// pace, as `cairn replay` does, and never pause. One second after each loop closure was sent, the
// poses that a client has by then are kept. Afterwards they are compared with the batch optimum of
// exactly the records that their solve has seen, the lower of two runs: from the beginning, and on
// from the live estimate. chi2 has every factor in it, also what the gate may have left out;
// closures between robots whose maps are not tied together yet are in neither. Behind the gate: a
// batch solve of the same records that decides anew what is let in, and chi2 of that.
// Usage: bench_live_against_batch [--rate POSES_PER_SECOND] [--most SOLVES] [GRAPH...]: of more
// solves than that (default: 300) it compares some, evenly spread.
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/support/daemon_run.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/apply_record.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/optimize.hpp"
#include "clients/cli/fleet.hpp"
#include "clients/client/client.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct DataSet {
  std::string name;
  std::vector<std::string> files;  ///< one per robot
  double pace = 1.0;               ///< times the rate: few poses are sent slowly
};

const std::vector<DataSet> kDataSets{
    {"intel", {"graphs/pose2/intel.g2o"}},
    {"manhattan", {"graphs/pose2/manhattan.g2o"}},
    {"parking-garage", {"graphs/pose3/parking-garage.g2o"}},
    {"sphere2500", {"graphs/pose3/sphere2500.g2o"}},
    {"argos_clean",
     {"graphs/multirobot/argos_clean_4robots/0.g2o", "graphs/multirobot/argos_clean_4robots/1.g2o",
      "graphs/multirobot/argos_clean_4robots/2.g2o", "graphs/multirobot/argos_clean_4robots/3.g2o"},
     0.1},
};

constexpr double kTolerance = 0.01;  // of chi2

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

// What a client has been sent so far.
struct Picture {
  EstimateRevisions revisions;
  std::map<std::pair<OdometryFrame, std::uint32_t>, std::shared_ptr<const PoseChunk>> chunks;
};

class Watcher {
 public:
  explicit Watcher(Client& client) : client_(client) {
    client.on_poses([this](const PoseUpdate& update) {
      auto next = std::make_shared<Picture>(*newest());
      next->revisions = update.revisions;
      for (const PoseChunk& chunk : update.chunks)
        next->chunks[{chunk.frame, chunk.chunk}] = std::make_shared<const PoseChunk>(chunk);
      const std::lock_guard lock(mutex_);
      newest_ = std::move(next);
    });
  }
  ~Watcher() { client_.on_poses({}); }

  std::shared_ptr<const Picture> newest() {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

 private:
  Client& client_;
  std::mutex mutex_;
  std::shared_ptr<const Picture> newest_ = std::make_shared<Picture>();
};

struct Closure {
  Clock::time_point sent;
  Submission submission;
  std::shared_ptr<const Picture> picture{};  ///< a second later
};

bool closes_loop(const Transaction& transaction) {
  return std::any_of(transaction.factors.begin(), transaction.factors.end(),
                     [](const NewFactor& f) { return is_gated(f.type, f.kind); });
}

std::size_t longest(const cli::Fleet& fleet) {
  std::size_t steps = 0;
  for (const auto& robot : fleet.robots) steps = std::max(steps, robot.transactions.size());
  return steps;
}

// All robots at the same pace. Between two steps, pictures that are due are taken.
std::vector<Closure> replay(cli::Fleet& fleet, std::vector<Client>& clients, double rate) {
  Watcher watcher(clients.front());
  std::vector<Closure> closures;
  std::size_t taken = 0;
  const auto take_due = [&] {
    for (; taken < closures.size() && Clock::now() >= closures[taken].sent + 1s; ++taken)
      closures[taken].picture = watcher.newest();
  };
  const auto start = Clock::now();
  // For a second after the last closure the robots stand, as they would.
  const auto steps = longest(fleet) + static_cast<std::size_t>(std::ceil(1.1 * rate));
  for (std::size_t i = 0; i < steps; ++i) {
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(i / rate)));
    take_due();
    for (std::size_t r = 0; r < fleet.robots.size(); ++r) {
      if (i >= fleet.robots[r].transactions.size()) continue;
      Transaction& step = fleet.robots[r].transactions[i];
      const bool closing = closes_loop(step);
      const auto at = Clock::now();
      Result<Submission> submission = clients[r].submit_async(std::move(step));
      if (!submission) give_up(submission.error().to_string());
      if (closing) closures.push_back({at, *submission});
    }
  }
  take_due();
  return closures;
}

// Poses of a picture, by node, and the map that each frame is in.
struct Live {
  std::map<NodeId, PoseNumbers> poses;
  std::map<OdometryFrame, std::string> map_of;

  explicit Live(const Picture& picture) {
    for (const auto& [place, chunk] : picture.chunks) {
      map_of[chunk->frame] = chunk->map;
      for (const PoseEstimate& pose : chunk->poses)
        poses[{chunk->frame, pose.index}] = pose.T_map_body;
    }
  }
};

struct Comparison {
  double excess = 0.0;        ///< of chi2 over that of a batch solve with every closure, relative
  double gated_excess = 0.0;  ///< over that of a batch solve behind the gate, of what it lets in
  double rmse_m = 0.0;        ///< of positions
};

double position_rmse(const Graph& a, const Graph& b) {
  double sum = 0.0;
  for (VariableSlot slot = 0; slot < a.variables().size(); ++slot) {
    const std::vector<double> x = describe_value(a, slot), y = describe_value(b, slot);
    const std::size_t dimensions = a.variables()[slot].type == VariableType::kPose2 ? 2 : 3;
    for (std::size_t k = 0; k < dimensions; ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
  }
  return std::sqrt(sum / static_cast<double>(a.variables().size()));
}

double excess(const Graph& shown, double optimum) {
  // A thousandth per degree of freedom is nothing: without closures the optimum is 0.
  const double nothing = 1e-3 * static_cast<double>(shown.factor_count());
  return (compute_chi2(shown) - optimum) / std::max(optimum, nothing);
}

// `map` is that of the records that the picture's solve has seen.
Comparison compare(PoseGraph map, const Picture& picture) {
  const Live live(picture);
  const CanonicalOrder order(map, [&](std::uint32_t f) {
    const auto map_of = [&](NodeIndex node) { return live.map_of.at(map.nodes[node].id.frame); };
    const std::vector<NodeIndex>& nodes = map.factors[f].nodes;
    return std::all_of(nodes.begin(), nodes.end(),
                       [&](NodeIndex node) { return map_of(node) == map_of(nodes[0]); });
  });
  Graph batch = canonical_graph(map, order);
  const SettledEstimate gated = settle(map);
  for (const NodeIndex node : order.nodes) {
    StoredNode& stored = map.nodes.edit(node);
    const PoseNumbers& pose = live.poses.at(stored.id);
    stored.start.assign(pose.begin(), pose.begin() + static_cast<long>(stored.start.size()));
  }
  const Graph as_published = canonical_graph(map, order);
  Graph polished = as_published;
  optimize(batch, optimizer_options({}));
  optimize(polished, {.init = InitMethod::kFile});
  if (compute_chi2(polished) < compute_chi2(batch)) batch = std::move(polished);
  return {excess(as_published, compute_chi2(batch)),
          excess(canonical_graph(map, gated.order), compute_chi2(gated.graph)),
          position_rmse(as_published, batch)};
}

struct Outcome {
  std::size_t closures = 0, late = 0, solves = 0, compared = 0, beyond = 0, beyond_gated = 0;
  std::size_t judged = 0;  ///< closures whose picture was compared
  double worst = 0.0, worst_rmse_m = 0.0, worst_gated = 0.0;
  std::map<FactorState, std::size_t> states;  ///< of loop closures, at the end
};

using Pictures = std::map<std::uint64_t, std::pair<std::shared_ptr<const Picture>, std::size_t>>;

// By what their solve has seen: with how many closures.
Pictures gather(const std::vector<Closure>& closures, Outcome& outcome) {
  Pictures pictures;
  for (const Closure& closure : closures) {
    const Result<Receipt> receipt = closure.submission.wait(60s);
    if (!receipt || receipt->refusal || !closure.picture) give_up("a closure was not accepted");
    ++outcome.closures;
    const std::uint64_t solved = closure.picture->revisions.solved.number;
    if (solved < receipt->revision.number) {
      ++outcome.late;
      continue;
    }
    const auto at = pictures.try_emplace(solved, closure.picture, 0).first;
    ++at->second.second;
  }
  outcome.solves = pictures.size();
  return pictures;
}

void compare_all(const Journal& journal, const Pictures& pictures, std::size_t most,
                 Outcome& outcome) {
  MapHead head;
  std::size_t place = 0;
  const auto chosen = [&](std::size_t i) {
    return pictures.size() <= most ||
           i * most / pictures.size() != (i + 1) * most / pictures.size();
  };
  const auto walked = journal.for_each(1, [&](const Record& record) -> Result<void> {
    if (auto applied = apply_record(record, journal.head().revision.store, head); !applied)
      return applied;
    const auto picture = pictures.find(record.number);
    if (picture == pictures.end() || !chosen(place++)) return {};
    const auto& [shown, closures] = picture->second;
    const Comparison found = compare(head.graph(), *shown);
    ++outcome.compared;
    outcome.judged += closures;
    if (!(found.excess <= kTolerance)) outcome.beyond += closures;
    if (!(found.gated_excess <= kTolerance)) outcome.beyond_gated += closures;
    outcome.worst = std::max(outcome.worst, found.excess);
    outcome.worst_gated = std::max(outcome.worst_gated, found.gated_excess);
    outcome.worst_rmse_m = std::max(outcome.worst_rmse_m, found.rmse_m);
    return {};
  });
  if (!walked) give_up(walked.error().to_string());
  for (std::size_t f = 0; f < head.graph().factors.size(); ++f) {
    const StoredFactor& factor = head.graph().factors[f];
    if (is_gated(factor.type, factor.kind)) ++outcome.states[factor.state];
  }
}

Outcome run(cli::Fleet fleet, double rate, std::size_t most) {
  const auto folder = bench::fresh_folder("live-against-batch");
  const std::uint32_t domain = test::own_domain();
  test::Process daemon(
      {CAIRND_BINARY, "--data", (folder / "data").string(), "--domain", std::to_string(domain)});
  std::vector<Client> clients;
  for (const cli::FleetRobot& robot : fleet.robots) {
    Result<Client> client = Client::connect({.domain = domain,
                                             .source = robot.name,
                                             .robot = robot.name,
                                             .spool = folder / ("spool-" + robot.name)});
    if (!client || !client->command("status", 30s)) give_up("no daemon");
    clients.push_back(std::move(*client));
  }
  const std::vector<Closure> closures = replay(fleet, clients, rate);
  Outcome outcome;
  const Pictures pictures = gather(closures, outcome);
  if (const auto settled = clients.front().command("settle", 10min); !settled)
    give_up(settled.error().to_string());
  clients.clear();
  if (daemon.end(SIGTERM).exit_code != 0) give_up("the daemon failed");
  const auto journal = Journal::open((folder / "data").string());
  if (!journal) give_up(journal.error().to_string());
  compare_all(**journal, pictures, most, outcome);
  std::filesystem::remove_all(folder);
  return outcome;
}

void print(const std::string& name, std::size_t poses, double rate, const Outcome& o) {
  const auto state = [&](FactorState s) { return o.states.contains(s) ? o.states.at(s) : 0; };
  std::printf(
      "| %s | %zu | %g | %zu | %zu | %zu of %zu | %zu | %zu | %.2g %% | %.2g | %zu | %.2g %% | %zu "
      "| %zu |\n",
      name.c_str(), poses, rate, o.closures, o.late, o.compared, o.solves, o.judged, o.beyond,
      100.0 * o.worst, o.worst_rmse_m, o.beyond_gated, 100.0 * o.worst_gated,
      state(FactorState::kQuarantined), state(FactorState::kPending));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  double rate = 100.0;
  std::size_t most = 300;
  std::set<std::string> only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--rate") == 0 && i + 1 < argc)
      rate = std::strtod(argv[++i], nullptr);
    else if (std::strcmp(argv[i], "--most") == 0 && i + 1 < argc)
      most = std::strtoul(argv[++i], nullptr, 10);
    else
      only.insert(argv[i]);
  }
  if (!(rate > 0.0) || most == 0) give_up("--rate and --most expect numbers above 0");
  const char* root = std::getenv("CAIRN_DATASETS");
  const std::string datasets = root ? root : CAIRN_SOURCE_DIR "/../shared/datasets";
  std::printf(
      "## The live map against batch solves, one second after each loop closure\n\n"
      "| data | poses | per second and robot | sent with closures | not solved after 1 s | solves "
      "compared | closures "
      "they "
      "have | chi2 beyond 1 %% | worst | worst position RMSE, m | beyond 1 %% behind the gate | "
      "worst | quarantined at the end | pending "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const DataSet& set : kDataSets) {
    if (!only.empty() && !only.contains(set.name)) continue;
    std::vector<std::string> files;
    for (const std::string& file : set.files) files.push_back(datasets + "/" + file);
    Result<cli::Fleet> fleet = cli::read_fleet(files, "robot-");
    if (!fleet) {
      std::fprintf(stderr, "%s is left out: %s\n", set.name.c_str(),
                   fleet.error().to_string().c_str());
      continue;
    }
    std::size_t poses = 0;
    for (const auto& robot : fleet->robots) poses += robot.transactions.size();
    const Outcome outcome = run(std::move(*fleet), set.pace * rate, most);
    print(set.name, poses, set.pace * rate, outcome);
    good = good && outcome.beyond == 0 && outcome.late == 0 &&
           !outcome.states.contains(FactorState::kQuarantined);
  }
  return good ? 0 : 1;
}
