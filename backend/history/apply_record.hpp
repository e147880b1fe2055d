// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/replay/map_head.hpp"

namespace cairn {

/// Asked now and then during long work; false ends it with an error.
using KeepGoing = std::function<bool()>;

/// Brings the head from the record before this one to this one: what a restart does. kBadInput
/// where the record does not fit the head.
Result<void> apply_record(const Record& record, std::uint64_t store, MapHead& head);

/// The same without the estimates of solves: for a head that is to get them from a snapshot.
Result<void> apply_beside_estimates(const Record& record, std::uint64_t store, MapHead& head);

/// The map after each of these records (ascending; 0: the empty map). kUsage where there is no such
/// record.
Result<std::vector<PoseGraph>> maps_at(const Journal& journal,
                                       const std::vector<std::uint64_t>& numbers,
                                       const KeepGoing& keep_going = {});

}  // namespace cairn
