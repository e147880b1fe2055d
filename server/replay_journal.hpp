// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/journal/journal.hpp"
#include "cairn/replay/map_head.hpp"
#include "server/sequencer.hpp"

namespace cairn {

/// Brings head and sequencer to the end of the journal: what a start does.
Result<void> replay_journal(const Journal& journal, MapHead& head, Sequencer& sequencer);

/// The record of a decision.
RecordBody record_of(Decision&& decision, std::int64_t arrival_ns);

}  // namespace cairn
