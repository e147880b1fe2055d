// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "server/config.hpp"

namespace cairn {

/// Serves the folder until SIGTERM or SIGINT; gives the exit code. Ends within two seconds of the
/// signal: a running solve is abandoned. Once per process. Of `config`, the
/// journal takes nothing: `journal` is all it gets.
int run_daemon(const std::string& folder, const DaemonConfig& config,
               const JournalOptions& journal = {});

}  // namespace cairn
