// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>

#include "cairn/replay/settle.hpp"

namespace cairn {

/// The settled estimate of the committed factors and of the loop closures that have come since the
/// last solve, where these fit and nothing else is to be looked at (Gate::kQuick). Its verdicts are
/// of the newcomers. Nothing: ask the whole gate. Interrupted or not usable: as settle().
std::optional<SettledEstimate> try_newcomers(const PoseGraph& map, const SettleOptions& options);

}  // namespace cairn
