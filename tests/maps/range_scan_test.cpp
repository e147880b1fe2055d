// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/range_scan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace cairn {
namespace {

RangeScan some_scan() {
  return {.first_angle_rad = -1.5,
          .angle_step_rad = 0.25,
          .max_range_m = 80.0,
          .T_body_laser = Se2(0.1, -0.2, std::numbers::pi),
          .ranges_m = {1.0F, 81.9F, 0.0F, 2.5F}};
}

std::string bytes_of(const RangeScan& scan) {
  const Result<std::string> bytes = encode(scan);
  EXPECT_TRUE(bytes.ok());
  return bytes.ok() ? *bytes : "";
}

TEST(RangeScan, SurvivesItsBytes) {
  const RangeScan scan = some_scan();
  const Result<RangeScan> read = decode_range_scan(bytes_of(scan));
  ASSERT_TRUE(read.ok()) << read.error().to_string();
  EXPECT_EQ(read->first_angle_rad, scan.first_angle_rad);
  EXPECT_EQ(read->angle_step_rad, scan.angle_step_rad);
  EXPECT_EQ(read->max_range_m, scan.max_range_m);
  EXPECT_EQ(read->T_body_laser.to_vector(), scan.T_body_laser.to_vector());
  EXPECT_EQ(read->ranges_m, scan.ranges_m);
}

TEST(RangeScan, WritesEverythingThatIsNoReadingAlike) {
  RangeScan scan = some_scan();
  scan.ranges_m = {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(),
                   -3.0F, -0.0F};
  RangeScan silent = some_scan();
  silent.ranges_m = {0.0F, 0.0F, 0.0F, 0.0F};
  EXPECT_EQ(bytes_of(scan), bytes_of(silent));
}

TEST(RangeScan, RefusesEveryBeginningOfItsBytesAndMore) {
  const std::string bytes = bytes_of(some_scan());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_range_scan(bytes.substr(0, size)).ok()) << size;
  EXPECT_FALSE(decode_range_scan(bytes + '\0').ok());
}

// The bytes that are accepted are those that would be written.
TEST(RangeScan, AcceptsOneStringForOneMeaning) {
  const std::string bytes = bytes_of(some_scan());
  int accepted = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ 1 << bit);
      const Result<RangeScan> read = decode_range_scan(changed);
      if (!read) continue;
      ++accepted;
      EXPECT_EQ(bytes_of(*read), changed) << "byte " << at << ", bit " << bit;
    }
  }
  EXPECT_GT(accepted, 300);
}

TEST(RangeScan, RefusesWhatNoLaserIs) {
  RangeScan scan = some_scan();
  scan.max_range_m = 0.0;
  EXPECT_EQ(encode(scan).error().message,
            "the scan has a max range that is no number above 0 and up to 10000 m");
  scan = some_scan();
  scan.angle_step_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(encode(scan).ok());
  scan = some_scan();
  scan.ranges_m.assign(kMaxBeams + 1, 1.0F);
  EXPECT_EQ(encode(scan).error().message, "the scan has more than 100000 beams");
  scan.ranges_m.pop_back();
  EXPECT_TRUE(encode(scan).ok());
}

TEST(RangeScan, SaysWhereItsBytesAreWrong) {
  std::string bytes = bytes_of(some_scan());
  bytes[0] = 2;
  EXPECT_EQ(decode_range_scan(bytes).error().to_string(),
            "byte 2: this is no laser_scan/1: it has an unknown version; 1 is expected");
}

}  // namespace
}  // namespace cairn
