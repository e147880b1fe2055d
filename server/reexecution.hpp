// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cairn/history/solve_record.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/replay/head_hash.hpp"
#include "server/sequencer.hpp"

namespace cairn {

/// What came out when a journal was executed again.
struct Reexecuted {
  std::uint64_t records = 0;
  std::uint64_t accepted = 0, refused = 0, commands = 0, verdicts = 0;
  std::uint64_t solves = 0;                 ///< solved again with the same result, bit for bit
  std::uint64_t solves_compared = 0;        ///< made elsewhere, and the same to 1e-9
  std::uint64_t solves_skipped = 0;         ///< by a method that this version does not know
  double largest_difference = 0.0;          ///< relative, among solves_compared
  std::vector<std::string> gaps{};          ///< sequences that neither store nor spool had any more
  std::optional<std::uint64_t> snapshot{};  ///< the record after which estimates are stored, alike
  std::optional<std::string> other_settings{};  ///< of the first of those
  ContentHash head_hash{};                      ///< HeadHash after the last record
};

/// Makes every decision of a journal again and solves every solve again. One thread.
class Reexecution {
 public:
  /// Called after each record, with the hash of the head.
  using OnRecord = std::function<void(const Record&, const ContentHash& head)>;

  explicit Reexecution(const Journal& journal);

  /// kBadInput, with the record, where something comes out otherwise than the journal says.
  /// Without `on_record`, the hash is computed after the last record only.
  Result<Reexecuted> run(const OnRecord& on_record = {});

 private:
  Result<void> find_bases();
  Result<void> execute(const Record& record);
  Result<void> execute(const TransactionRecord& record, const Revision& revision);
  Result<void> decide_again(const Transaction& transaction, const TransactionRecord& record,
                            const Revision& revision);
  Result<void> order_again(const CommandRecord& record, const Revision& revision);
  Result<void> execute(const SolveRecord& record, const Record& whole);
  Result<void> check_snapshot(std::uint64_t number);
  Result<void> solve_again(const SolveRecord& record, std::uint64_t number);
  [[nodiscard]] Result<void> judge_verdicts(const SolveRecord& record,
                                            const std::vector<VerdictRecord>& again,
                                            std::uint64_t number) const;
  Result<void> judge(const SolveRecord& record, const PoseGraph& again, const PoseGraph& recorded,
                     std::uint64_t number);

  const Journal& journal_;
  std::vector<VerdictRecord> verdicts_;  ///< since the last record that was none, of one era
  std::uint32_t era_ = 0;
  MapHead head_;
  Sequencer sequencer_;
  std::map<std::uint64_t, std::uint64_t> uses_of_base_;  ///< by record: solves of it to come
  std::map<std::uint64_t, PoseGraph> bases_;
  std::optional<Journal::Snapshot> snapshot_;  ///< what a start would begin with
  Reexecuted result_;
};

}  // namespace cairn
