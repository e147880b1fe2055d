// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cairn/core/result.hpp"

namespace cairn::cli {

/// Checks the output paths of a verb before it starts to work (empty ones were not asked for): at
/// most one is "-", no two are the same file, and each can be written.
Result<void> check_outputs(const std::vector<std::string>& paths);

}  // namespace cairn::cli
