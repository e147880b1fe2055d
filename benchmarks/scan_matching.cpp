// SPDX-License-Identifier: BSD-3-Clause
// From how far off does each way to match a scan find home, and in what time? Success is within
// 5 cm and 0.5 deg. Starts are drawn from a fixed seed, so success rates repeat; making maps and
// grids is not in the times.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "datasets/random.hpp"
#include "frontends/carmen/carmen_log.hpp"
#include "frontends/laser/laser_tracker.hpp"
#include "frontends/matching/correlative.hpp"
#include "frontends/matching/icp.hpp"
#include "frontends/simulated/simulated_drive.hpp"

namespace cairn::bench {
namespace {

using Points = std::vector<SurfacePoint>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSuccessM = 0.05, kSuccessRad = 0.5 * kDegree;
constexpr double kReachM = 1.0;  // at first: as far as the worst start is off
struct StartError {
  double m, deg;
};
constexpr std::array kStartErrors{StartError{0.1, 5.0}, StartError{0.25, 10.0},
                                  StartError{0.5, 20.0}, StartError{1.0, 30.0}};
constexpr int kDraws = 3;  // of starts, per case and error

/// A scan, what it is matched with, and where it was.
struct Case {
  Case(Points map, Points seen, const Se2& truth)
      : near(map, PointToLineOptions{}.first_reach_m),
        far(map, kReachM),
        grid(map, LikelihoodGrid::Options{}),
        scan(std::move(seen)),
        T_map_scan(truth) {}
  PointMap near, far;  // by reach
  LikelihoodGrid grid;
  Points scan;
  Se2 T_map_scan;
};

struct Contender {
  std::string name, reach;
  std::function<std::optional<Se2>(const Case&, const Se2& start)> match;
  std::array<int, kStartErrors.size()> successes{};
  std::vector<double> seconds{}, errors_m{};
};

// The same variants with both reaches: kept, as their authors had it, and shrinking, as the tracker
// has it.
void add_icp_variants(std::vector<Contender>& all, const std::string& reach, double last_reach_m) {
  using Kind = RobustLoss::Kind;
  constexpr auto kPoint = IcpMetric::kPointToPoint;
  constexpr auto kLine = IcpMetric::kPointToLine;
  constexpr auto kClosest = IcpPairing::kClosest;
  constexpr auto kLike = IcpPairing::kClosestCompatible;
  const auto add = [&](const std::string& name, IcpOptions options) {
    options.first_reach_m = kReachM;
    options.last_reach_m = last_reach_m;
    const auto match = [options](const Case& one, const Se2& start) -> std::optional<Se2> {
      const auto found = match_icp(one.far, one.scan, start, options);
      if (!found || found->stop == IcpStop::kTooFewPairs) return std::nullopt;
      return found->T_map_scan;
    };
    all.push_back({name, reach, match});
  };
  const auto robust = [](Kind kind, double width) {
    return IcpOptions{.metric = kLine, .pairing = kLike, .loss = RobustLoss(kind, width)};
  };
  add("point to point, closest", {.metric = kPoint, .pairing = kClosest});
  add("point to point, closest, trimmed 0.8",
      {.metric = kPoint, .pairing = kClosest, .keep_share = 0.8});
  add("point to point, compatible", {.metric = kPoint, .pairing = kLike});
  add("point to line, closest", {.metric = kLine, .pairing = kClosest});
  add("point to line, compatible", {.metric = kLine, .pairing = kLike});
  add("point to line, compatible, trimmed 0.8",
      {.metric = kLine, .pairing = kLike, .keep_share = 0.8});
  add("point to line, compatible, Huber", robust(Kind::kHuber, 1.345));
  add("point to line, compatible, Cauchy", robust(Kind::kCauchy, 2.385));
  add("point to line, compatible, Geman-McClure", robust(Kind::kGemanMcClure, 2.0));
  add("point to line, compatible, Tukey", robust(Kind::kTukey, 4.685));
}

std::vector<Contender> contenders() {
  const auto tracker = [](double reach_m) {
    return [reach_m](const Case& one, const Se2& start) -> std::optional<Se2> {
      const PointMap& map = reach_m < kReachM ? one.near : one.far;
      return match_point_to_line(map, one.scan, start, {.first_reach_m = reach_m}).T_map_scan;
    };
  };
  const auto search = [](const Case& one, const Se2& start) -> std::optional<Se2> {
    const auto found = match_correlative(one.grid, one.scan, start, {1.1, 1.1, 0.55}, 0.3);
    if (!found) return std::nullopt;
    return match_point_to_line(one.near, one.scan, found->T_map_scan, {.first_reach_m = 0.25})
        .T_map_scan;
  };
  std::vector<Contender> all;
  add_icp_variants(all, "1 m", kReachM);
  add_icp_variants(all, "1 to 0.12 m", 0.12);
  all.push_back({"the tracker's", "0.5 to 0.12 m", tracker(0.5)});
  all.push_back({"the tracker's", "1 to 0.12 m", tracker(kReachM)});
  all.push_back({"correlative search, then the tracker's", "0.25 to 0.12 m", search});
  return all;
}

// Where surfaces fix every direction; along a bare corridor there is no right answer.
void add_case(std::vector<Case>& cases, Points map, Points scan, const Se2& T_map_scan) {
  Case one(std::move(map), std::move(scan), T_map_scan);
  if (match_point_to_line(one.near, one.scan, T_map_scan).free == 0)
    cases.push_back(std::move(one));
}

// Scans 0.5 s apart, which is 0.5 m or a turn.
std::vector<Case> simulated_pairs() {
  std::vector<Case> cases;
  const SimulatedDrive drive = simulate_drive();
  for (std::size_t i = 0; i + 5 < drive.scans.size(); i += 45)
    add_case(cases, surface_points(drive.scans[i]), surface_points(drive.scans[i + 5]),
             drive.truth[i].inverse() * drive.truth[i + 5]);
  return cases;
}

// Keyframes of the tracker against the five before and the five after.
std::vector<Case> logged_keyframes(const std::string& path) {
  std::vector<Case> cases;
  const Result<CarmenLog> log = read_carmen_log(path);
  if (!log) {
    std::fprintf(stderr, "left out: %s\n", log.error().to_string().c_str());
    return cases;
  }
  LaserTracker tracker;
  for (const LaserScan& scan : log->scans) tracker.track(scan);
  const auto& keyframes = tracker.keyframes();
  for (std::size_t k = 5; k + 5 < keyframes.size(); k += 40) {
    Points map;
    for (std::size_t other = k - 5; other <= k + 5; ++other) {
      if (other == k) continue;
      const Points seen = moved(keyframes[other].T_odom_laser, keyframes[other].points);
      map.insert(map.end(), seen.begin(), seen.end());
    }
    add_case(cases, std::move(map), keyframes[k].points, keyframes[k].T_odom_laser);
  }
  return cases;
}

Se2 draw_error(Random& random, const StartError& error) {
  const double direction = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double turn = random.chance(0.5) ? error.deg : -error.deg;
  return {error.m * std::cos(direction), error.m * std::sin(direction), turn * kDegree};
}

void run_one(Contender& contender, const Case& one, const Se2& start, std::size_t bin) {
  const Stopwatch watch;
  const std::optional<Se2> found = contender.match(one, start);
  contender.seconds.push_back(watch.seconds());
  if (!found) return;
  const Se2 error = one.T_map_scan.inverse() * *found;
  const double metres = error.translation().norm();
  if (metres > kSuccessM || std::abs(error.theta()) > kSuccessRad) return;
  ++contender.successes[bin];
  contender.errors_m.push_back(metres);
}

void compare(const std::string& title, const std::vector<Case>& cases) {
  if (cases.empty()) return;
  std::vector<Contender> all = contenders();
  Random random(11);
  for (const Case& one : cases)
    for (std::size_t bin = 0; bin < kStartErrors.size(); ++bin)
      for (int draw = 0; draw < kDraws; ++draw) {
        const Se2 start = one.T_map_scan * draw_error(random, kStartErrors[bin]);
        for (Contender& contender : all) run_one(contender, one, start, bin);
      }
  const double starts = static_cast<double>(cases.size()) * kDraws;
  std::printf("\n## %s: %zu scans, %.0f starts a column\n", title.c_str(), cases.size(), starts);
  std::vector<std::string> columns{"success, % from", "reach"};
  for (const StartError& error : kStartErrors)
    columns.push_back(number_text(error.m) + " m, " + number_text(error.deg, 0) + " deg");
  columns.insert(columns.end(), {"median error where successful", "median time"});
  const Table table(columns);
  for (const Contender& contender : all) {
    std::vector<std::string> row{contender.name, contender.reach};
    for (const int successes : contender.successes)
      row.push_back(number_text(100.0 * successes / starts, 0));
    row.push_back(contender.errors_m.empty()
                      ? "none"
                      : number_text(1e3 * median(contender.errors_m), 1) + " mm");
    row.push_back(time_text(median(contender.seconds)));
    table.row(row);
  }
}

}  // namespace
}  // namespace cairn::bench

int main() {
  using namespace cairn::bench;
  keep_freed_memory();
  const char* root = std::getenv("CAIRN_DATASETS");
  compare("Simulated building, scan to scan, against truth", simulated_pairs());
  compare(
      "Intel, keyframe to its ten neighbors, against the tracker",
      logged_keyframes(std::string(root ? root : "../shared/datasets") + "/laser/intel.clf.bz2"));
  return 0;
}
