// SPDX-License-Identifier: BSD-3-Clause
// Which odometry a scan gets, by stamps that may be anything.
#include <gtest/gtest.h>

#include "frontends/carmen/carmen_log.hpp"
#include "frontends/host/epoch_watch.hpp"
#include "frontends/ros/scan_queue.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kMs = 1'000'000;

LaserScan scan_at(std::int64_t ms) {
  LaserScan scan;
  scan.stamp_ns = ms * kMs;
  return scan;
}
StampedPose at(std::int64_t ms, double x, double yaw = 0.0) { return {ms * kMs, Se2(x, 0.0, yaw)}; }

TEST(OdometryBuffer, InterpolatesBetweenNeighbors) {
  OdometryBuffer buffer;
  buffer.add(at(1000, 0.0));
  buffer.add(at(1100, 1.0));
  EXPECT_NEAR(buffer.at(1025 * kMs)->x(), 0.25, 1e-12);
  EXPECT_EQ(buffer.at(1100 * kMs)->x(), 1.0);
  EXPECT_FALSE(buffer.at(999 * kMs));  // before everything
}

TEST(OdometryBuffer, InterpolatesAlongTheArcAndTheShortWayAround) {
  OdometryBuffer buffer;
  buffer.add(at(0, 0.0, 3.0));
  buffer.add({200 * kMs, Se2(0.0, 0.0, 3.0) * Se2::exp({1.0, 0.0, 1.0})});
  const Se2 half = *buffer.at(100 * kMs);
  const Se2 expected = Se2(0.0, 0.0, 3.0) * Se2::exp({0.5, 0.0, 0.5});
  EXPECT_TRUE((half.to_vector() - expected.to_vector()).isZero(1e-12));
}

TEST(OdometryBuffer, TakesTheOneBeforeUnlessItIsOld) {
  OdometryBuffer buffer;
  buffer.add(at(1000, 5.0));
  EXPECT_EQ(buffer.at(1500 * kMs)->x(), 5.0);
  EXPECT_FALSE(buffer.at(1501 * kMs));
  buffer.add(at(2600, 6.0));  // too far from the one before
  EXPECT_EQ(buffer.at(1400 * kMs)->x(), 5.0);
  EXPECT_FALSE(buffer.at(2000 * kMs));
}

TEST(OdometryBuffer, SortsWhatComesLateAndKeepsTheLastOfEqualStamps) {
  OdometryBuffer buffer;
  buffer.add(at(1100, 1.0));
  buffer.add(at(1000, 0.0));
  buffer.add(at(1050, 7.0));
  buffer.add(at(1050, 0.5));
  EXPECT_NEAR(buffer.at(1025 * kMs)->x(), 0.25, 1e-12);
  EXPECT_EQ(buffer.newest_ns(), 1100 * kMs);
}

TEST(OdometryBuffer, BeginsAnewWhereTheClockWasSetBack) {
  OdometryBuffer buffer;
  buffer.add(at(100'000, 1.0));
  buffer.add(at(98'000, 2.0));  // 2 s: late
  EXPECT_TRUE(buffer.reaches(100'000 * kMs));
  buffer.add(at(97'000, 3.0));
  EXPECT_FALSE(buffer.reaches(98'000 * kMs));
  EXPECT_EQ(buffer.at(97'000 * kMs)->x(), 3.0);
}

TEST(OdometryBuffer, IsBounded) {
  OdometryBuffer buffer;
  for (int i = 0; i < 30'000; ++i) buffer.add({i, Se2()});
  EXPECT_FALSE(buffer.at(30'000 - OdometryBuffer::kMost - 1));
  EXPECT_TRUE(buffer.at(30'000 - OdometryBuffer::kMost));
}

TEST(ScanQueue, GivesScansInOrderOfArrivalWithTheirOdometry) {
  ScanQueue queue(true);
  queue.set_T_base_laser(Se2(0.0, 1.0, 0.0));
  queue.push(at(1000, 0.0));
  queue.push(at(1100, 1.0));
  EXPECT_TRUE(queue.push(scan_at(1050)));
  EXPECT_TRUE(queue.push(scan_at(1010)));  // stamps are labels
  const auto first = queue.pop(ScanQueue::Clock::now()),
             second = queue.pop(ScanQueue::Clock::now());
  ASSERT_TRUE(first && second);
  EXPECT_NEAR(first->T_odom_laser->x(), 0.5, 1e-12);
  EXPECT_NEAR(first->T_odom_laser->y(), 1.0, 1e-12);
  EXPECT_NEAR(second->T_odom_laser->x(), 0.1, 1e-12);
  EXPECT_FALSE(queue.pop(ScanQueue::Clock::now()));
}

TEST(ScanQueue, WaitsForOdometryOfTheScansTimeButNotForEver) {
  ScanQueue queue(true);
  queue.push(at(1000, 0.0));
  const auto now = ScanQueue::Clock::now();
  queue.push(scan_at(1050), now);
  EXPECT_FALSE(queue.pop(now));
  queue.push(at(1100, 1.0));
  EXPECT_NEAR(queue.pop(now)->T_odom_laser->x(), 0.5, 1e-12);
  queue.push(scan_at(1150), now - ScanQueue::kPatience);
  EXPECT_EQ(queue.pop(now)->T_odom_laser->x(), 1.0);  // the one before
  queue.push(scan_at(9000), now - ScanQueue::kPatience);
  const auto without = queue.pop(now);
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->T_odom_laser);
  EXPECT_EQ(queue.counts().without_odometry, 1u);
}

TEST(ScanQueue, DoesNotWaitWhereThereIsNoOdometry) {
  ScanQueue queue(false);
  queue.push(scan_at(1050));
  const auto scan = queue.pop(ScanQueue::Clock::now());
  ASSERT_TRUE(scan);
  EXPECT_FALSE(scan->T_odom_laser);
  EXPECT_EQ(queue.counts().without_odometry, 0u);
}

TEST(ScanQueue, DropsTheOldestWhereTheFrontEndIsBehindAndCountsIt) {
  ScanQueue queue(false);
  for (std::size_t i = 0; i < ScanQueue::kMost; ++i)
    EXPECT_TRUE(queue.push(scan_at(static_cast<std::int64_t>(i))));
  EXPECT_FALSE(queue.push(scan_at(99)));
  EXPECT_EQ(queue.pop(ScanQueue::Clock::now())->stamp_ns, 1 * kMs);
  EXPECT_EQ(queue.counts().arrived, ScanQueue::kMost + 1);
  EXPECT_EQ(queue.counts().dropped, 1u);
}

TEST(EpochWatch, LetsStampsRepeatAndGoBackByTwoSeconds) {
  EpochWatch watch;
  for (const std::int64_t ms : {5000, 5000, 3000, 5100, 3100, 3100, 900'000, 898'000})
    EXPECT_FALSE(watch.begins_anew(ms * kMs)) << ms;
}

TEST(EpochWatch, TakesARealLogWhoseStampsGoBackForOneEpoch) {
  CAIRN_REQUIRE_DATASET(intel, "laser/intel.clf.bz2");
  const auto log = read_carmen_log(intel);
  ASSERT_TRUE(log);
  EpochWatch watch;
  int back = 0;
  for (const LaserScan& scan : log->scans) {
    back += watch.newest() && scan.stamp_ns < *watch.newest();
    EXPECT_FALSE(watch.begins_anew(scan.stamp_ns));
  }
  EXPECT_EQ(back, 1612);
}

TEST(EpochWatch, BeginsAnewFurtherBack) {
  EpochWatch watch;
  EXPECT_FALSE(watch.begins_anew(5000 * kMs));
  EXPECT_FALSE(watch.begins_anew(4000 * kMs));
  EXPECT_TRUE(watch.begins_anew(3000 * kMs - 1));  // behind the newest, not the one before
  EXPECT_FALSE(watch.begins_anew(3000 * kMs));
  EXPECT_FALSE(watch.begins_anew(1000 * kMs));
  EXPECT_TRUE(watch.begins_anew(INT64_MIN));
  EXPECT_FALSE(watch.begins_anew(INT64_MAX));
  EXPECT_TRUE(watch.begins_anew(INT64_MIN));
}

}  // namespace
}  // namespace cairn
