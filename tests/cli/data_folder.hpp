// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cairn/history/solve_record.hpp"
#include "server/replay_journal.hpp"
#include "tests/server/drive.hpp"

namespace cairn::test {

/// Fills a data folder as a daemon would, without one.
class DataFolderMaker {
 public:
  explicit DataFolderMaker(const std::string& folder) : journal_(*Journal::open(folder)) {}

  void submit(Transaction transaction, const std::string& source = "laser") {
    Revision next = journal_->head().revision;
    ++next.number;
    transaction.key = {source, 7, ++sequences_[source]};
    Sequencer::Outcome outcome;
    sequencer_.take(make_arrival(std::move(transaction)), {now(), head_, next, outcome});
    ASSERT_EQ(outcome.decisions.size(), 1u);
    append(record_of(std::move(outcome.decisions.front()), now()));
  }
  void submit_all(const std::vector<Transaction>& transactions) {
    for (const Transaction& transaction : transactions) submit(transaction);
  }
  /// `spoil` may change the record before it is written.
  void solve(const std::function<void(SolveRecord&)>& spoil = {}) {
    const MapSolution solution = solve_map(head_.graph());
    const Revision base = head_.graph().graph_revision;
    Revision next = base;
    ++next.number;
    for (RecordBody& record : apply_solution(head_, base, solution, next)) {
      if (auto* solve = std::get_if<SolveRecord>(&record); solve != nullptr && spoil) spoil(*solve);
      append(std::move(record));
    }
  }
  ContentHash put_payload(std::string_view bytes) { return *journal_->put_payload(bytes); }
  Revision append(RecordBody body) {
    const Result<Revision> revision = journal_->append({&body, 1});
    EXPECT_TRUE(revision) << revision.error().to_string();
    return *revision;
  }
  [[nodiscard]] const PoseGraph& map() const { return head_.graph(); }

 private:
  // 2026-01-01 00:00:00, and a second more for each record.
  [[nodiscard]] std::int64_t now() const {
    return (1'767'225'600 + static_cast<std::int64_t>(journal_->head().revision.number)) *
           1'000'000'000;
  }

  std::unique_ptr<Journal> journal_;
  MapHead head_;
  Sequencer sequencer_;
  std::map<std::string, std::uint64_t> sequences_;
};

/// A transaction that is refused: it ties to a node of its own robot that does not exist.
inline Transaction impossible_step() {
  Transaction step = drive(2).back();
  step.variables.front().node.index = 99'999;
  step.factors.front().nodes = {{{"robot", 3}, 77'777}, {{"robot", 3}, 99'999}};
  return step;
}

}  // namespace cairn::test
