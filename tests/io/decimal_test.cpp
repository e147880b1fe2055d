// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/decimal.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <random>
#include <string>

namespace cairn {
namespace {

// A value with its sign of zero, and how much of the text it took; nothing where refused.
std::string taken(const std::string& text) {
  double value = 0.0;
  const char* rest = take_decimal(text.data(), text.data() + text.size(), value);
  if (!rest) return "refused";
  return std::to_string(std::bit_cast<std::uint64_t>(value)) + " until " +
         std::to_string(rest - text.data());
}
std::string expected(const std::string& text) {
  double value = 0.0;
  const auto [rest, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc()) return "refused";
  return std::to_string(std::bit_cast<std::uint64_t>(value)) + " until " +
         std::to_string(rest - text.data());
}

TEST(Decimal, RoundsAsTheStandardLibraryDoes) {
  for (const char* text : {"0",
                           "-0",
                           "-0.0",
                           "1.",
                           ".5",
                           "-.5",
                           "50 0",
                           "0.1",
                           "00000000000000000001",
                           "1e5",
                           "1E+05",
                           "1e22",
                           "1e23",
                           "123456789012345678e-27",
                           "123456789012345678e-28",
                           "1.5e-07",
                           "1e-400",
                           "1e",
                           "1e+",
                           "1e12345",
                           "9007199254740993",
                           "9007199254740993.0",
                           "4503599627370496.5",
                           "4503599627370497.5",
                           "4503599627370497.500000000000001",
                           "9999999999999999999",
                           "99999999999999999999",
                           "18446744073709551615",
                           "0.9999999999999999999",
                           "-",
                           ".",
                           "-.",
                           "e5",
                           "",
                           "-+1",
                           "1.2.3",
                           "12345678",
                           "1.12345678",
                           "1.123456789012345678"}) {
    EXPECT_EQ(taken(text), expected(text)) << text;
  }
}

TEST(Decimal, RoundsRandomNumbersAsTheStandardLibraryDoes) {
  std::mt19937_64 random(7);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  const auto digits = [&](std::uint64_t count) {
    std::string text;
    for (; count > 0; --count) text += static_cast<char>('0' + below(10));
    return text;
  };
  for (int i = 0; i < 300'000; ++i) {
    std::string text = below(2) ? "-" : "";
    text += digits(1 + below(3)) + "." + digits(below(19));
    if (below(3) == 0) text += "e-" + digits(2);
    if (below(8) == 0) text += "e" + digits(1);
    ASSERT_EQ(taken(text), expected(text)) << text;
  }
}

// What our writer prints, 17 digits and all, must come back.
TEST(Decimal, ReadsBackEveryDoubleFromItsShortestDigits) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300'000; ++i) {
    const double value = std::ldexp(normal(random), static_cast<int>(random() % 120) - 80);
    char text[32];
    const char* end = std::to_chars(text, text + sizeof text, value).ptr;
    double back;
    ASSERT_EQ(take_decimal(text, end, back), end);
    ASSERT_EQ(back, value) << std::string_view(text, static_cast<std::size_t>(end - text));
  }
}

TEST(Decimal, RefusesWhatIsNotFinite) {
  for (const char* text : {"nan", "inf", "-inf", "1e999"}) EXPECT_EQ(taken(text), "refused");
}

TEST(Decimal, TakesWholeNumbersBelow2To64) {
  const auto id = [](const std::string& text) -> std::string {
    std::uint64_t value = 0;
    const char* rest = take_decimal(text.data(), text.data() + text.size(), value);
    return rest ? std::to_string(value) + " until " + std::to_string(rest - text.data())
                : "refused";
  };
  EXPECT_EQ(id("0"), "0 until 1");
  EXPECT_EQ(id("12 3"), "12 until 2");
  EXPECT_EQ(id("1.5"), "1 until 1");
  EXPECT_EQ(id("18446744073709551615"), "18446744073709551615 until 20");
  EXPECT_EQ(id("000000000000000000000007"), "7 until 24");
  for (const char* text : {"", "-1", "x", "18446744073709551616"}) EXPECT_EQ(id(text), "refused");
}

}  // namespace
}  // namespace cairn
