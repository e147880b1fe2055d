// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// What benchmarks of the real daemon share.
namespace cairn::bench {

/// Sorts. NaN of nothing.
double percentile_ms(std::vector<double>& seconds, double part);

/// Of 600 bytes appended to a file in `folder`, ms.
double fdatasync_p50_ms(const std::filesystem::path& folder);

/// DAEMON_FOLDER/NAME (default: here), empty.
std::filesystem::path fresh_folder(const std::string& name);

}  // namespace cairn::bench
