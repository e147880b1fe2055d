// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "cairn/journal/journal.hpp"
#include "tests/support/transactions.hpp"

namespace cairn::test {

/// The n-th record of a journal: mostly transactions, all kinds among them. The same for the same
/// n.
inline RecordBody some_record(std::uint64_t n) {
  const Transaction transaction = some_transaction(n);
  const auto time = static_cast<std::int64_t>(n) * 1'000'000;
  switch (n % 20) {
    case 5:
      return CommandRecord{"anna", "the lift was a mirror", "revoke robot-1/laser/1/3", time};
    case 9: {
      VerdictRecord verdict;
      verdict.factor = {transaction.key, 1};
      verdict.test = "pairwise consistency";
      verdict.value = 3.5;
      verdict.threshold = 7.8;
      verdict.disagreeing = {{transaction.key, 0}};
      verdict.state = FactorState::kQuarantined;
      return verdict;
    }
    case 13: {
      SolveRecord solve;
      solve.base = n - 1;
      solve.settings = "method lm, kernel portable";
      solve.start = "live";
      solve.work_limit = 1'000'000;
      for (std::uint64_t i = 0; i < 10; ++i)
        solve.changed.push_back({{{"robot-1", 77}, i}, VariableType::kPose2, {1.0, 2.0, 0.5}});
      solve.estimates_hash = content_hash("estimates");
      return solve;
    }
    case 17: {
      RefusedTransaction refused{transaction.key, RefusalCode::kConflict, "node 17 exists already"};
      return TransactionRecord{refused, content_hash("what was sent"), time};
    }
    default:
      return TransactionRecord{transaction, content_hash(encode(transaction)), time};
  }
}

inline std::vector<RecordBody> some_records(std::uint64_t first, std::uint64_t last) {
  std::vector<RecordBody> records;
  for (std::uint64_t n = first; n <= last; ++n) records.push_back(some_record(n));
  return records;
}

/// The chain hash after some_record(1) ... some_record(n) in era 0: [n].
inline std::vector<ContentHash> some_chain(std::uint64_t last) {
  std::vector<ContentHash> chain(1);
  for (std::uint64_t n = 1; n <= last; ++n)
    chain.push_back(chain_in(encode_record(n, 0, some_record(n), chain.back())));
  return chain;
}

/// Opens or fails the test.
inline std::unique_ptr<Journal> open_journal(const std::string& folder,
                                             const JournalOptions& options = {}) {
  Result<std::unique_ptr<Journal>> journal = Journal::open(folder, options);
  EXPECT_TRUE(journal) << (journal ? "" : journal.error().to_string());
  return journal ? std::move(*journal) : nullptr;
}

/// Appends some_record(from) to some_record(to) in groups.
inline void append_some(Journal& journal, std::uint64_t from, std::uint64_t to,
                        std::uint64_t group = 7) {
  for (std::uint64_t n = from; n <= to; n += group) {
    const auto records = some_records(n, std::min(n + group - 1, to));
    const Result<Revision> revision = journal.append(records);
    ASSERT_TRUE(revision) << revision.error().to_string();
  }
}

}  // namespace cairn::test
