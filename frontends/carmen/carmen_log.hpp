// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "frontends/api/laser_scan.hpp"

namespace cairn {

struct CarmenOptions {
  /// From the first beam to the last, for FLASER lines whose number of readings does not tell.
  std::optional<double> field_of_view_rad{};
};

/// The scans of one laser.
struct CarmenLog {
  std::string name;                     ///< of the file, for messages
  std::vector<LaserScan> scans{};       ///< in order of the file, never empty
  std::vector<std::string> warnings{};  ///< "file:line:column: message"
};

/// Reads a CARMEN log, text, .gz or .bz2. Its scans are the ROBOTLASER1 lines where there are any,
/// else FLASER, else RAWLASER1; their odometry is their own or the ODOM line before. What is
/// damaged is an error with file:line:column, but for a last line that was cut, which is left out
/// with a warning. Grammar and rules: frontends/carmen/README.md.
Result<CarmenLog> read_carmen_log(const std::string& path, const CarmenOptions& options = {});

/// The same from memory; `name` stands for the file in messages.
Result<CarmenLog> read_carmen_text(std::string_view text, const std::string& name,
                                   const CarmenOptions& options = {});

}  // namespace cairn
