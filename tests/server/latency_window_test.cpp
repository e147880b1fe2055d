// SPDX-License-Identifier: BSD-3-Clause
#include "server/latency_window.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

using namespace std::chrono_literals;

const LatencyWindow::Clock::time_point kStart{1000s};

TEST(LatencyWindow, TellsPercentilesWithinTheWidthOfABin) {
  LatencyWindow window;
  EXPECT_EQ(window.summarize(kStart).count, 0u);
  EXPECT_EQ(window.summarize(kStart).p99_ms, 0.0);
  for (int ms = 1; ms <= 1000; ++ms) window.add(kStart, std::chrono::milliseconds(ms));
  const auto summary = window.summarize(kStart + 1s);
  EXPECT_EQ(summary.count, 1000u);
  EXPECT_NEAR(summary.p50_ms, 500.0, 0.1 * 500.0);
  EXPECT_NEAR(summary.p99_ms, 990.0, 0.1 * 990.0);
  EXPECT_GE(summary.most_ms, 1000.0);
}

TEST(LatencyWindow, ForgetsWhatIsOlderThanAMinute) {
  LatencyWindow window;
  window.add(kStart, 3s);
  window.add(kStart + 30s, 1ms);
  EXPECT_EQ(window.summarize(kStart + 59s).count, 2u);
  EXPECT_EQ(window.summarize(kStart + 61s).count, 1u);
  EXPECT_LT(window.summarize(kStart + 61s).most_ms, 2.0);
  window.add(kStart + 3600s, 1ms);
  EXPECT_EQ(window.summarize(kStart + 3600s).count, 1u);
}

TEST(LatencyWindow, TakesWhatIsOutOfItsRange) {
  LatencyWindow window;
  window.add(kStart, -5s);
  window.add(kStart, 0s);
  window.add(kStart, std::chrono::hours(10'000));
  EXPECT_EQ(window.summarize(kStart).count, 3u);
  EXPECT_GT(window.summarize(kStart).most_ms, 3.6e6);
}

}  // namespace
}  // namespace cairn
