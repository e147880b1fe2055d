// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>
#include <vector>

namespace cairn::test {
namespace {

TEST(ThreadPool, CallsEachIndexOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.threads(), threads);
    for (const std::size_t count : {0, 1, 2, 7, 1000}) {
      std::vector<std::atomic<int>> calls(count);
      pool.run(count, [&](std::size_t i) { ++calls[i]; });
      for (std::size_t i = 0; i < count; ++i)
        EXPECT_EQ(calls[i], 1) << threads << " threads, index " << i;
    }
  }
}

TEST(ThreadPool, WritesAreVisibleWhenRunReturns) {
  ThreadPool pool(2);
  std::vector<std::size_t> squares(100);
  for (int round = 1; round < 500; ++round) {
    pool.run(squares.size(),
             [&](std::size_t i) { squares[i] = i * i * static_cast<std::size_t>(round); });
    for (std::size_t i = 0; i < squares.size(); ++i)
      ASSERT_EQ(squares[i], i * i * static_cast<std::size_t>(round));
  }
}

TEST(ThreadPool, WakesSleepingWorkers) {
  ThreadPool pool(2);
  for (int round = 0; round < 20; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::atomic<int> sum = 0;
    pool.run(10, [&](std::size_t i) { sum += static_cast<int>(i); });
    ASSERT_EQ(sum, 45);
  }
}

TEST(ThreadPool, OneThreadRunsInPlaceAndInOrder) {
  ThreadPool pool(1);
  std::vector<std::size_t> order;
  std::set<std::thread::id> threads;
  pool.run(50, [&](std::size_t i) {
    order.push_back(i);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

TEST(ThreadPool, StopsWithoutEverHavingRun) {
  for (int round = 0; round < 100; ++round) ThreadPool pool(3);
}

}  // namespace
}  // namespace cairn::test
