// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "idl/messages.hpp"

namespace cairn {

/// What `cairn status --json` prints. Of a folder (`is_folder`), what only a daemon knows is null.
nlohmann::ordered_json to_json(const Status& status, bool is_folder);

}  // namespace cairn
