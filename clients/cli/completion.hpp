// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace cairn::cli {

/// A bash script that completes verbs, options and the words options take; elsewhere file names.
std::string bash_completion(const CLI::App& app);

}  // namespace cairn::cli
