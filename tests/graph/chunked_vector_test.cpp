// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/chunked_vector.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace cairn {
namespace {

ChunkedVector<int> counting(int size) {
  ChunkedVector<int> numbers;
  for (int i = 0; i < size; ++i) numbers.push_back(i);
  return numbers;
}

TEST(ChunkedVector, CopiesAreTheirOwn) {
  ChunkedVector<int> numbers = counting(5000);
  const ChunkedVector<int> before = numbers;
  numbers.edit(3) = -3;
  numbers.edit(4999) = -4999;
  numbers.push_back(5000);
  EXPECT_EQ(before.size(), 5000u);
  EXPECT_EQ(before[3], 3);
  EXPECT_EQ(before[4999], 4999);
  std::vector<std::size_t> changed;
  numbers.for_each_changed(before, [&](std::size_t i) { changed.push_back(i); });
  EXPECT_EQ(changed, (std::vector<std::size_t>{3, 4999}));
}

// For ThreadSanitizer: the flag says that the copy has gone and orders nothing, as the scheduler
// may well let it be.
TEST(ChunkedVector, MayBeWrittenToWhenAReaderDroppedItsCopy) {
  for (int round = 0; round < 100; ++round) {
    ChunkedVector<int> numbers = counting(10);
    std::atomic<bool> dropped{false};
    std::thread reader([&dropped, copy = numbers]() mutable {
      int sum = 0;
      for (std::size_t i = 0; i < copy.size(); ++i) sum += copy[i];
      EXPECT_EQ(sum, 45);
      copy = {};
      dropped.store(true, std::memory_order_relaxed);
    });
    while (!dropped.load(std::memory_order_relaxed)) std::this_thread::yield();
    numbers.edit(0) = round;
    EXPECT_EQ(numbers[0], round);
    reader.join();
  }
}

}  // namespace
}  // namespace cairn
