// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cairn/core/result.hpp"

namespace cairn::cli {

/// Checks the output paths of a verb before it starts to work (empty ones were not asked for): at
/// most one is "-", no two are the same file, and each can be written.
Result<void> check_outputs(const std::vector<std::string>& paths);

/// Writes files, path and content: all of them or, up to the renaming, none. Compressed as their
/// names say.
Result<void> write_files(const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace cairn::cli
