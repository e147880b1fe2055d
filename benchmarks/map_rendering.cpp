// SPDX-License-Identifier: BSD-3-Clause
// How many cells a second does rendering update, on one thread? An update is one cell, once per
// scan, however many beams meet it.
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/maps/map_renderer.hpp"
#include "frontends/carmen/carmen_log.hpp"

namespace cairn::bench {
namespace {

struct Drive {
  std::string name;
  std::vector<std::shared_ptr<const RangeScan>> scans;
  std::vector<PlacedScan> placed;

  void add(RangeScan scan, const Se2& T_map_body) {
    placed.push_back({scans.size(), T_map_body});
    scans.push_back(std::make_shared<RangeScan>(std::move(scan)));
  }
};

// Every scan 0.5 m or 0.3 rad after the one before, at its wheel odometry.
Drive read_drive(const std::string& name, const std::string& path) {
  Drive drive{name, {}, {}};
  Se2 last(1e9, 0.0, 0.0);
  Result<CarmenLog> read = read_carmen_log(path);
  if (!read) {
    std::fprintf(stderr, "%s\n", read.error().to_string().c_str());
    return drive;
  }
  for (LaserScan& scan : read->scans) {
    if (!scan.T_odom_laser) continue;
    const Se2 step = last.inverse() * *scan.T_odom_laser;
    if (step.translation().norm() < 0.5 && std::abs(step.theta()) < 0.3) continue;
    last = *scan.T_odom_laser;
    drive.add({scan.first_angle_rad, scan.angle_step_rad, scan.max_range_m, Se2(),
               std::move(scan.ranges_m)},
              last);
  }
  return drive;
}

// 1081 beams over 270 degrees in a hall of 40 x 25 m.
Drive simulate_hall() {
  Drive drive{"hall, 1081 beams", {}, {}};
  constexpr double kStep = 0.25 * std::numbers::pi / 180.0;
  for (int k = 0; k < 200; ++k) {
    const Se2 pose(2.0 + 0.18 * k, 12.0 + 8.0 * std::sin(0.05 * k), 0.1 * k);
    RangeScan scan{-540 * kStep, kStep, 60.0, Se2(), {}};
    for (int i = 0; i < 1081; ++i) {
      const double angle = pose.theta() + scan.first_angle_rad + i * kStep;
      const double x = std::cos(angle), y = std::sin(angle);
      const double to_x = (x > 0 ? 40.0 - pose.x() : -pose.x()) / x;
      const double to_y = (y > 0 ? 25.0 - pose.y() : -pose.y()) / y;
      scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
    }
    drive.add(std::move(scan), pose);
  }
  return drive;
}

double updates_of(const Drive& drive, double resolution_m) {
  double updates = 0.0;
  LaserCells cells;
  for (const PlacedScan& placed : drive.placed) {
    cells.trace(*drive.scans[placed.scan], placed.T_map_body, resolution_m);
    cells.for_each_tile([&](const TileIndex&, const LaserEvidence& evidence) {
      for (int row = 0; row < kTileCells; ++row)
        updates += std::popcount(evidence.hits[row]) + std::popcount(evidence.misses[row]);
    });
  }
  return updates;
}

void measure(const Drive& drive, double resolution_m, const Table& table) {
  const double updates = updates_of(drive, resolution_m);
  const ScanSource source = [&](ScanId id) { return drive.scans[id]; };
  std::size_t tiles = 0;
  const std::function<double()> contenders[] = {[&] {
    const Stopwatch watch;
    LaserMap map(resolution_m);
    map.render(drive.placed, source, Precision::kExact);
    tiles = map.grid().size();
    return watch.seconds();
  }};
  const double seconds = interleaved_medians(15, contenders)[0];
  table.row({drive.name, std::to_string(drive.scans.size()), number_text(resolution_m, 3),
             number_text(updates / 1e6, 1), std::to_string(tiles), time_text(seconds),
             number_text(updates / seconds / 1e6, 0)});
}

}  // namespace
}  // namespace cairn::bench

int main() {
  using namespace cairn::bench;
  keep_freed_memory();
  std::printf("## Rendering a map from nothing, one thread, median of 15\n");
  const Table table(
      {"scans", "number", "cell, m", "updates, millions", "tiles", "time", "million updates/s"});
  const char* root = std::getenv("CAIRN_DATASETS");
  const std::string folder = std::string(root ? root : "../shared/datasets") + "/laser/";
  std::vector<Drive> drives{simulate_hall()};
  for (const char* name : {"intel", "mit-csail"})
    drives.push_back(read_drive(name, folder + name + ".clf.bz2"));
  for (const Drive& drive : drives) {
    if (drive.scans.empty()) continue;
    for (const double resolution_m : {0.1, 0.05, 0.025}) measure(drive, resolution_m, table);
  }
  return 0;
}
