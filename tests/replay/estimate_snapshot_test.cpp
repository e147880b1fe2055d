// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/estimate_snapshot.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

PoseGraph three_nodes() {
  PoseGraph map;
  map.solved_revision = {7, 1, 42};
  for (int i = 0; i < 3; ++i) map.estimates.push_back({0.1 * i, -2.0, 3.0, 0.0, 0.0, 0.0, 1.0});
  return map;
}

TEST(EstimateSnapshot, GivesBackWhatItHolds) {
  const PoseGraph map = three_nodes();
  const auto snapshot = decode_snapshot(encode_snapshot(map, 1.5));
  ASSERT_TRUE(snapshot) << snapshot.error().to_string();
  EXPECT_EQ(snapshot->solved, map.solved_revision);
  EXPECT_EQ(snapshot->chi2, 1.5);
  ASSERT_EQ(snapshot->estimates.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(snapshot->estimates[i], map.estimates[i]);
}

TEST(EstimateSnapshot, RefusesWhatItCannotHaveWritten) {
  const std::string good = encode_snapshot(three_nodes(), 1.5);
  EXPECT_EQ(decode_snapshot("").error().message, "a snapshot of version 0; expected 1");
  std::string newer = good;
  newer[0] = 2;
  EXPECT_EQ(decode_snapshot(newer).error().message, "a snapshot of version 2; expected 1");
  EXPECT_EQ(decode_snapshot(good + "x").error().to_string(),
            "byte " + std::to_string(good.size()) + ": the snapshot goes on behind its end");
  for (std::size_t size = 2; size < good.size(); ++size)
    EXPECT_FALSE(decode_snapshot(good.substr(0, size))) << size;
  std::string greedy = good;
  for (std::size_t i = 30; i < 34; ++i) greedy[i] = '\xff';
  EXPECT_EQ(decode_snapshot(greedy).error().message, "the snapshot holds less than its count says");
}

}  // namespace
}  // namespace cairn
