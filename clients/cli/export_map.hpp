// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "clients/cli/verb.hpp"

namespace cairn::cli {

/// Adds `export map`: the subcommand, and what runs when it is chosen.
std::pair<CLI::App*, Run> add_export_map(CLI::App& export_verb);

}  // namespace cairn::cli
