// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "cairn/io/record_scanner.hpp"
#include "frontends/api/laser_scan.hpp"

namespace cairn {

/// The lines of a log that hold scans.
enum class ScanKind { kRobotLaser, kFlaser, kRawLaser };
inline constexpr std::array<std::string_view, 3> kScanTags{"ROBOTLASER1", "FLASER", "RAWLASER1"};

/// A line with a scan, as it is written.
struct ScanLine {
  std::size_t line = 0, readings_column = 0;          ///< in the file
  LaserScan scan{};                                   ///< FLASER: without angles and largest range
  std::optional<Se2> T_odom_laser{}, T_odom_robot{};  ///< nothing where not all are finite
  std::size_t odd_readings = 0;                       ///< neither a number nor infinite
};

/// Errors name file:line:column.
Result<ScanLine> read_scan_line(const Record& record, ScanKind kind, std::string_view file);

/// ODOM x y theta ...: nothing where a number is not finite.
Result<std::optional<Se2>> read_odometry_line(const Record& record, std::string_view file);

/// PARAM name value ...: the value of a parameter that is a number.
std::optional<double> read_parameter(const Record& record, std::string_view name);

}  // namespace cairn
