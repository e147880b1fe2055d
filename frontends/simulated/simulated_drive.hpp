// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "frontends/api/laser_scan.hpp"
#include "frontends/simulated/floor_plan.hpp"

namespace cairn {

/// Of wheels. One part of the errors is drawn once for a drive, the other anew from scan to scan.
struct WheelNoise {
  double length_scale = 0.004, turn_scale = 0.01;  ///< sigma of what stays, per m and per rad
  double drift_rad_m = 0.001;                      ///< sigma of the turn per m that stays
  double length_m = 0.01, turn_rad = 0.01;         ///< sigma over one m; over one rad or m
  double slips_per_m = 0.02;                       ///< a wheel spins
  double slip_m = 0.03, slip_rad = 0.03;           ///< sigma of one slip
};

struct SimulatedLaser {
  std::size_t beams = 361;
  double first_angle_rad = -0.5 * std::numbers::pi, angle_step_rad = std::numbers::pi / 360.0;
  double max_range_m = 12.0;
  double sigma_m = 0.01;
  double dropout = 0.002;    ///< share of beams that read 0
  double glass_seen = 0.35;  ///< share of beams that glass reflects
};

struct DriveOptions {
  std::uint64_t seed = 1;
  FloorPlan plan = office_floor();
  double speed_m_s = 1.0, turn_rad_s = 1.2;
  double period_s = 0.1;  ///< from scan to scan
  WheelNoise wheels{};
  SimulatedLaser laser{};
};

/// What a robot records on a tour, its laser in its middle. Beams without echo read max_range_m.
struct SimulatedDrive {
  std::vector<LaserScan> scans{};  ///< stamps from 0; odometry begins at 0 0 0
  std::vector<Se2> truth{};        ///< T_plan_laser, scan by scan
  FloorPlan plan{};
};

/// The same bits for the same options on every machine. Ranges are rounded to mm, odometry to um
/// and urad. A tour that does not come to its end in an hour is cut there.
SimulatedDrive simulate_drive(const DriveOptions& options = {});

}  // namespace cairn
