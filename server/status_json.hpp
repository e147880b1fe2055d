// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "cairn/history/source_trust.hpp"
#include "cairn/journal/record.hpp"
#include "cairn/replay/map_head.hpp"
#include "idl/messages.hpp"

namespace cairn {

/// What `cairn status --json` prints. Of a folder (`is_folder`), what only a daemon knows is null.
nlohmann::ordered_json to_json(const Status& status, bool is_folder);

/// Its keys quarantine and trust, and how many of each source's loops are quarantined. `why` may
/// know of others, too.
void add_judgement(nlohmann::ordered_json& status, const MapHead& head,
                   const std::map<FactorName, VerdictRecord>& why,
                   const std::vector<SourceTrust>& trust);

}  // namespace cairn
