// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "cairn/core/result.hpp"
#include "frontends/api/laser_scan.hpp"

namespace cairn {

/// Reads the FLASER and ROBOTLASER1 lines of a CARMEN log (text, .gz or .bz2), in the order of the
/// file.
Result<void> read_carmen_log(const std::string& path,
                             const std::function<void(LaserScan&&)>& on_scan);

}  // namespace cairn
