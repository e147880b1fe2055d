// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/apply_record.hpp"

#include <gtest/gtest.h>

#include "cairn/history/solve_record.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

Transaction step(std::uint64_t index) {
  Transaction transaction;
  transaction.key = {"laser", 7, index + 1};
  const NodeId pose{{"robot", 3}, index};
  transaction.variables.push_back(
      {pose, VariableType::kPose2, {1.1 * static_cast<double>(index), 0.1, 0.0}, 0, {}});
  if (index == 0) return transaction;
  transaction.factors.push_back({FactorType{1},
                                 FactorKind::kOdometry,
                                 {{pose.frame, index - 1}, pose},
                                 {1.0, 0.0, 0.0, 100.0, 0.0, 0.0, 100.0, 0.0, 400.0}});
  return transaction;
}

TEST(MapsAt, GivesTheMapAfterEachRecord) {
  const test::TemporaryFolder folder;
  const auto journal = *Journal::open(folder.file("data"));
  MapHead head;
  for (std::uint64_t i = 0; i < 5; ++i) {
    const RecordBody body = TransactionRecord{step(i), content_hash(encode(step(i))), 0};
    const auto revision = journal->append({&body, 1});
    ASSERT_TRUE(revision);
    head.apply(step(i), *revision);
  }
  const Revision base = head.graph().graph_revision;
  Revision next = base;
  ++next.number;
  ASSERT_TRUE(journal->append(apply_solution(head, base, solve_map(head.graph()), next)));

  const auto maps = maps_at(*journal, {0, 2, 2, 5, 6});
  ASSERT_TRUE(maps) << maps.error().to_string();
  ASSERT_EQ(maps->size(), 5u);
  EXPECT_EQ((*maps)[0].nodes.size(), 0u);
  EXPECT_EQ((*maps)[1].nodes.size(), 2u);
  EXPECT_EQ((*maps)[2].graph_revision.number, 2u);
  EXPECT_EQ((*maps)[3].factors.size(), 4u);
  EXPECT_EQ(hash_estimates((*maps)[4]), hash_estimates(head.graph()));
  EXPECT_EQ((*maps)[4].solved_revision.number, 5u);

  const auto beyond = maps_at(*journal, {7});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().message, "there is no revision 7; the newest is 6");
  int asked = 0;
  EXPECT_FALSE(maps_at(*journal, {6}, [&] { return ++asked < 3; }));
}

TEST(ApplyRecord, NamesTheRecordThatDoesNotFit) {
  MapHead head;
  Record record{4, 0, TransactionRecord{step(1), {}, 0}, {}};
  const auto applied = apply_record(record, 1, head);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().place, "record 4");
  EXPECT_EQ(applied.error().code, ErrorCode::kBadInput);
}

TEST(SolveSettings, AreReadBackAndKnowEarlyRecords) {
  const SolveSettings here = SolveSettings::here();
  EXPECT_EQ(SolveSettings::parse(here.to_string()), here);
  const SolveSettings early =
      SolveSettings::parse("lm, multifrontal, portable, initialization auto");
  EXPECT_EQ(early.known(), SolveMethod{SolveKind::kUngated});
  EXPECT_TRUE(early.ungated());
  EXPECT_FALSE(here.ungated());
  EXPECT_EQ(here.known(), SolveMethod{});
  for (const SolveMethod& method :
       {SolveMethod{SolveKind::kLive}, SolveMethod{SolveKind::kLive, 12},
        SolveMethod{SolveKind::kSettled, 1}})
    EXPECT_EQ(SolveSettings::here(method).known(), method);
  for (const char* text :
       {"somehow; somewhere", "lm, multifrontal, portable, initialization auto, gate ",
        "lm, multifrontal, portable, initialization auto, gate 3x; here",
        "lm, multifrontal, portable, initialization auto, gate 03; here"})
    EXPECT_EQ(SolveSettings::parse(text).known(), std::nullopt) << text;
}

}  // namespace
}  // namespace cairn
