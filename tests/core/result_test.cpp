// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/result.hpp"

#include <gtest/gtest.h>

#include "cairn/core/ids.hpp"

namespace cairn::test {
namespace {

Result<std::unique_ptr<int>> read_number(bool well) {
  if (!well) return Error{ErrorCode::kBadInput, "expected a number", "numbers.txt:3:1"};
  return std::make_unique<int>(42);
}

TEST(Result, HoldsAValueThatCanBeMovedOut) {
  auto number = read_number(true);
  ASSERT_TRUE(number.ok());
  EXPECT_EQ(**number, 42);
  const std::unique_ptr<int> owned = *std::move(number);
  EXPECT_EQ(*owned, 42);
}

TEST(Result, NamesThePlaceBeforeTheMessage) {
  const auto number = read_number(false);
  ASSERT_FALSE(number);
  EXPECT_EQ(number.error().to_string(), "numbers.txt:3:1: expected a number");
  EXPECT_EQ(number.error().code, ErrorCode::kBadInput);
  EXPECT_EQ((Error{ErrorCode::kUsage, "no place"}.to_string()), "no place");
}

TEST(Result, OfVoidIsSuccessByDefault) {
  EXPECT_TRUE(Result<void>().ok());
  EXPECT_FALSE(Result<void>(Error{}).ok());
}

TEST(ResultDeathTest, AbortsWhenTheWrongSideIsRead) {
  EXPECT_DEATH((void)read_number(false).value(), "internal error: value\\(\\) of a Result");
  EXPECT_DEATH((void)read_number(true).error(), "internal error: error\\(\\) of a Result");
}

TEST(StrongId, OrdersByValueAndHashesNeighborsApart) {
  EXPECT_LT(VariableId{3}, VariableId{5});
  EXPECT_EQ(VariableId{7}, VariableId{7});
  const std::hash<VariableId> hash;
  EXPECT_NE(hash(VariableId{1}) & 0xFFFF, hash(VariableId{2}) & 0xFFFF);
  const std::uint64_t robot = std::uint64_t{'b'} << 56;
  EXPECT_NE(hash(VariableId{robot | 1}) & 0xFFFF, hash(VariableId{1}) & 0xFFFF);
}

}  // namespace
}  // namespace cairn::test
