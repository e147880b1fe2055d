// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "cairn/journal/journal.hpp"
#include "cairn/replay/map_head.hpp"
#include "server/sequencer.hpp"

namespace cairn {

/// What a start knows besides head and sequencer.
struct Replayed {
  std::uint64_t snapshot = 0;  ///< the record after which the snapshot was taken; 0: there was none
  std::map<FactorName, VerdictRecord> quarantined{};  ///< why, of those that are
  std::optional<double> chi2{};  ///< of the estimates, where no record came after the snapshot
};

/// Brings head and sequencer to the end of the journal: transactions from all records, estimates
/// from the newest snapshot and what came after it. `on_record` is called before each record.
Result<Replayed> replay_journal(const Journal& journal, MapHead& head, Sequencer& sequencer,
                                const std::function<void()>& on_record = {});

/// The record of a decision.
RecordBody record_of(Decision&& decision, std::int64_t arrival_ns);

}  // namespace cairn
