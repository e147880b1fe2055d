// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace cairn {
namespace {

TEST(Statistics, AgreeWithNumbersComputedByHand) {
  // mean 4, squares 1 + 4 + 9 + 100 = 114, deviations -3 -2 -1 6.
  const Statistics s = compute_statistics(std::array{10.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(s.mean, 4.0);
  EXPECT_DOUBLE_EQ(s.standard_deviation, std::sqrt(50.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(114.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 10.0);
}

TEST(Statistics, MedianOfAnOddCountIsTheMiddleOne) {
  EXPECT_DOUBLE_EQ(compute_statistics(std::array{9.0, 1.0, 5.0}).median, 5.0);
}

TEST(Statistics, OfOneNumberHaveNoDeviation) {
  const Statistics s = compute_statistics(std::array{2.0});
  EXPECT_DOUBLE_EQ(s.mean, 2.0);
  EXPECT_DOUBLE_EQ(s.standard_deviation, 0.0);
  EXPECT_DOUBLE_EQ(s.median, 2.0);
}

TEST(Statistics, OfNothingAreNotNumbers) { EXPECT_TRUE(std::isnan(compute_statistics({}).rmse)); }

}  // namespace
}  // namespace cairn
