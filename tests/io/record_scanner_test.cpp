// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/record_scanner.hpp"

#include <gtest/gtest.h>

#include <array>

namespace cairn {
namespace {

Record only_record(std::string_view text, char separator = ' ') {
  RecordScanner scanner(text, separator);
  Record record, another;
  EXPECT_TRUE(scanner.next(record));
  EXPECT_FALSE(scanner.next(another));
  return record;
}

TEST(RecordScanner, SkipsBlankLinesCommentsAndByteOrderMark) {
  const Record record = only_record("\xEF\xBB\xBF# head\n\n  \t\r\nFIX 3 # the origin\r\n#end");
  EXPECT_EQ(record.tag, "FIX");
  EXPECT_EQ(record.line, "FIX 3");
  EXPECT_EQ(record.line_number, 4u);
}

TEST(RecordScanner, TakesTheLastLineWithoutLineEnd) {
  RecordScanner scanner("A 1\nB 2");
  Record record;
  ASSERT_TRUE(scanner.next(record));
  ASSERT_TRUE(scanner.next(record));
  EXPECT_EQ(record.tag, "B");
  EXPECT_EQ(record.line_number, 2u);
  EXPECT_FALSE(scanner.next(record));
}

TEST(RecordScanner, TellsTheColumnOfEachField) {
  const Record record = only_record("  EDGE  12\t-4");
  FieldCursor fields(record);
  EXPECT_EQ(fields.next()->column, 9u);
  const auto second = fields.next();
  EXPECT_EQ(second->text, "-4");
  EXPECT_EQ(second->column, 12u);
  EXPECT_FALSE(fields.next());
  EXPECT_EQ(count_fields(record), 2u);
}

TEST(RecordScanner, SplitsAtCommasWhenAsked) {
  const Record record = only_record("P,1, 2 ,,3", ',');
  EXPECT_EQ(record.tag, "P");
  EXPECT_EQ(count_fields(record), 4u);
  FieldCursor fields(record);
  EXPECT_EQ(fields.next()->text, "1");
  EXPECT_EQ(fields.next()->text, "2");
}

TEST(ReadFields, TakesEveryWayToWriteADecimalNumber) {
  const Record record = only_record("T 18446744073709551615 8.85e+001 +1 .5 1. -0 1e-400 4.9E-324");
  std::array<std::uint64_t, 1> ids;
  std::array<double, 7> numbers;
  const Result<void> read = read_fields(record, "f", ids, numbers);
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(ids[0], ~std::uint64_t{0});
  EXPECT_EQ(numbers[0], 88.5);
  EXPECT_EQ(numbers[1], 1.0);
  EXPECT_EQ(numbers[2], 0.5);
  EXPECT_EQ(numbers[3], 1.0);
  EXPECT_EQ(numbers[5], 0.0);
  EXPECT_EQ(numbers[6], 4.9e-324);
}

TEST(ReadFields, TakesLinesWithAndWithoutTheNumbersThatMayBeLeftOut) {
  std::array<std::uint64_t, 1> ids;
  std::array<double, 4> numbers;
  const auto read = [&](std::string_view line) -> std::string {
    const auto count = read_fields(only_record(line), "f", ids, numbers, 2);
    return count ? std::to_string(*count) : count.error().to_string();
  };
  EXPECT_EQ(read("T 1 2 3 4 5"), "4");
  EXPECT_EQ(read("T 1 2 3"), "2");
  EXPECT_EQ(read("T 1 2 1e-400"), "2");
  EXPECT_EQ(read("T 1 2"), "f:1:1: T expects 5 numbers, found 2");
  EXPECT_EQ(read("T 1 2 3 4"), "f:1:1: T expects 5 numbers, found 4");
  EXPECT_EQ(read("T 1 2 x"), "f:1:7: 'x' is not a number");
  EXPECT_EQ(read("T 1 2 3 4 x"), "f:1:11: 'x' is not a number");
}

struct Malformed {
  std::string_view line;
  std::string message;
};

class ReadFieldsRefuses : public testing::TestWithParam<Malformed> {};

TEST_P(ReadFieldsRefuses, WithPlaceAndReason) {
  const Record record = only_record(GetParam().line);
  std::array<std::uint64_t, 1> ids;
  std::array<double, 2> numbers;
  const Result<void> read = read_fields(record, "f", ids, numbers);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().to_string(), GetParam().message);
}

const std::string kNotAnId = "' is not an id (a whole number from 0 to 18446744073709551615)";
INSTANTIATE_TEST_SUITE_P(
    Lines, ReadFieldsRefuses,
    testing::Values(
        Malformed{"T 1 2", "f:1:1: T expects 3 numbers, found 2"},
        Malformed{"T 1 2 3 4", "f:1:1: T expects 3 numbers, found 4"},
        Malformed{"T", "f:1:1: T expects 3 numbers, found 0"},
        Malformed{"T 1 nan 3", "f:1:5: 'nan' is not a finite number"},
        Malformed{"T 1 2 -inf", "f:1:7: '-inf' is not a finite number"},
        Malformed{"T 1 2,5 3", "f:1:5: '2,5' has a decimal comma; write 2.5"},
        Malformed{"T 1 0x1F 3", "f:1:5: '0x1F' is hexadecimal; write a decimal number"},
        Malformed{"T 1 1e999 3", "f:1:5: '1e999' is beyond the largest number (1.8e308)"},
        Malformed{"T 1 2 three", "f:1:7: 'three' is not a number"},
        Malformed{"T 1 2 3\x01", "f:1:7: '3\\x01' is not a number"},
        Malformed{"T 1 +-2 3", "f:1:5: '+-2' is not a number"},
        Malformed{"T 1 2 --3", "f:1:7: '--3' is not a number"},
        Malformed{"T -1 2 3", "f:1:3: '-1" + kNotAnId},
        Malformed{"T 1.5 2 3", "f:1:3: '1.5" + kNotAnId},
        Malformed{"T 18446744073709551616 2 3", "f:1:3: '18446744073709551616" + kNotAnId},
        Malformed{"T x 2 3", "f:1:3: 'x" + kNotAnId}));

TEST(Quote, CutsLongTextAndEscapesWhatDoesNotPrint) {
  EXPECT_EQ(quote(std::string(100, 'a')), std::string(40, 'a') + "...");
  EXPECT_EQ(quote("a\tb\xFF"), "a\\x09b\\xFF");
}

}  // namespace
}  // namespace cairn
