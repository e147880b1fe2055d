// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/record_json.hpp"

#include <gtest/gtest.h>

#include "tests/journal/records.hpp"

namespace cairn {
namespace {

TEST(Time, IsWrittenInUtcWithMilliseconds) {
  EXPECT_EQ(to_utc(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(to_utc(1'767'225'600'250'999'999), "2026-01-01T00:00:00.250Z");
  EXPECT_EQ(to_utc(-1), "1969-12-31T23:59:59.999Z");
}

TEST(RecordJson, TellsEveryKindOfRecord) {
  const auto record = [](std::uint64_t n) { return Record{n, 2, test::some_record(n), {}}; };
  EXPECT_EQ(kind_of(record(5)), "command");
  EXPECT_EQ(summarize(record(5)), "anna: revoke robot-1/laser/1/3 (the lift was a mirror)");
  EXPECT_EQ(to_json(record(5))["operator"], "anna");
  EXPECT_EQ(kind_of(record(9)), "verdict");
  EXPECT_TRUE(
      summarize(record(9)).ends_with("is quarantined: pairwise consistency 3.5 (limit 7.8)"));
  EXPECT_EQ(to_json(record(9))["disagreeing"].size(), 1u);
  EXPECT_FALSE(time_of(record(9)));
  EXPECT_EQ(kind_of(record(13)), "solve");
  EXPECT_EQ(summarize(record(13)), "of record 12: 10 estimates changed");
  EXPECT_EQ(to_json(record(13))["changed"][3]["node"], "robot-1/77/3");
  EXPECT_EQ(key_of(record(13)), nullptr);
  EXPECT_EQ(kind_of(record(17)), "refusal");
  EXPECT_EQ(summarize(record(17)), "conflict: node 17 exists already");
  EXPECT_EQ(to_json(record(17))["reason"], "node 17 exists already");
  EXPECT_EQ(kind_of(record(1)), "transaction");
  const Record first = record(1);
  const auto json = to_json(first);
  const auto& sent = std::get<Transaction>(std::get<TransactionRecord>(first.body).outcome);
  EXPECT_EQ(json["variables"].size(), sent.variables.size());
  EXPECT_EQ(json["factors"].size(), sent.factors.size());
  EXPECT_EQ(json["era"], 2);
}

TEST(RecordJson, KeepsGoingWhereNamesAreNoText) {
  Record record{1, 0, CommandRecord{"\xff\xfe", "", "freeze", 0}, {}};
  EXPECT_NE(
      to_json(record).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).find("freeze"),
      std::string::npos);
}

}  // namespace
}  // namespace cairn
