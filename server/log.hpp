// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "server/config.hpp"

namespace cairn {

/// From now on log() writes to standard error, as lines for people or as JSON objects with the keys
/// time, level, kind, text and, where there is one, revision.
void open_log(LogFormat format, Severity from);

/// One line. `kind` is a stable word, as in Event. From any thread.
void log(Severity severity, std::string_view kind, std::string_view text,
         const Revision& revision = {});

}  // namespace cairn
