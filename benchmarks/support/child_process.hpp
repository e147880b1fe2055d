// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::bench {

/// What a process did.
struct ChildReport {
  double peak_bytes = 0.0;      ///< peak resident memory, libraries included
  std::vector<double> numbers;  ///< what it printed
};

/// Runs this program again with other arguments, and reads the numbers it prints. Nothing when it
/// failed.
std::optional<ChildReport> run_this_program(const std::vector<std::string>& arguments);

}  // namespace cairn::bench
