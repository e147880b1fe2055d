// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/time_stamp.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(TimeStamp, DecimalsAreExactToTheNanosecond) {
  EXPECT_EQ(parse_stamp_ns("976052857.337530"), 976052857337530000u);
  EXPECT_EQ(parse_stamp_ns("1305031102.160407123"), 1305031102160407123u);
  EXPECT_EQ(parse_stamp_ns("0"), 0u);
  EXPECT_EQ(parse_stamp_ns("5."), 5000000000u);
  EXPECT_EQ(parse_stamp_ns("9000000000"), 9000000000000000000u);
}

TEST(TimeStamp, DigitsBeyondTheNanosecondAreRounded) {
  EXPECT_EQ(parse_stamp_ns("1.0000000004999"), 1000000000u);
  EXPECT_EQ(parse_stamp_ns("1.0000000005"), 1000000001u);
  EXPECT_EQ(parse_stamp_ns("1.00000000009999"), 1000000000u);
  EXPECT_EQ(parse_stamp_ns("1.9999999999"), 2000000000u);
}

TEST(TimeStamp, OtherNotationsGoThroughADouble) {
  EXPECT_EQ(parse_stamp_ns("1e3"), 1000000000000u);
  EXPECT_EQ(parse_stamp_ns("+2.5"), 2500000000u);
  EXPECT_EQ(parse_stamp_ns(".25"), 250000000u);
}

TEST(TimeStamp, WhatIsNoneIsRefused) {
  for (const char* text : {"", "-1", "x", "1.5s", "nan", "inf", "9000000000.1", "9999999999",
                           "1e10", "99999999999", "1.2.3", "0x10", "1,5"})
    EXPECT_EQ(parse_stamp_ns(text), std::nullopt) << text;
}

TEST(TimeStamp, IsWrittenAsItWasRead) {
  EXPECT_EQ(format_stamp(976052857337530000), "976052857.337530000");
  EXPECT_EQ(format_stamp(5), "0.000000005");
  EXPECT_EQ(format_stamp(-1500000000), "-1.500000000");
}

}  // namespace
}  // namespace cairn
