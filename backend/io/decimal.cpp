// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/decimal.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace cairn {
namespace {

__extension__ using Uint128 = unsigned __int128;

constexpr std::ptrdiff_t kMaxDigits = 19;  // a number of so many digits fits into 64 bits
constexpr int kMaxExactPower = 22;         // 10^22 is the largest power of ten that is a double
constexpr int kMaxPower = 27;              // 5^27 is the largest power of five below 2^64

template <class Number, std::size_t kCount>
constexpr std::array<Number, kCount> powers_of(Number base) {
  std::array<Number, kCount> powers{1};
  for (std::size_t i = 1; i < kCount; ++i) powers[i] = base * powers[i - 1];
  return powers;
}
constexpr auto kExactPowersOfTen = powers_of<double, kMaxExactPower + 1>(10.0);
constexpr auto kPowersOfFive = powers_of<std::uint64_t, kMaxPower + 1>(5);
constexpr auto kPowersOfTen = powers_of<std::uint64_t, 9>(10);

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The number that 8 digits of one byte each make, the first in the lowest byte: two by two.
std::uint64_t joined(std::uint64_t digits) {
  const std::uint64_t pairs = (digits * 10 + (digits >> 8)) & 0x00FF00FF00FF00FF;
  const std::uint64_t fours = (pairs * 100 + (pairs >> 16)) & 0x0000FFFF0000FFFF;
  return (fours * 10'000 + (fours >> 32)) & 0xFFFFFFFF;
}

// Appends the digits at `p` to a number, eight at a time: how many there are is hard to predict,
// and a processor that guesses wrong loses more time than it takes to read them.
const char* take_digits(const char* p, const char* end, std::uint64_t& number) {
  while (std::endian::native == std::endian::little && end - p >= 8) {
    std::uint64_t digits;
    std::memcpy(&digits, p, 8);
    digits ^= 0x3030303030303030;  // digits become 0 to 9, anything else is more
    const std::uint64_t others = (digits | (digits + 0x7676767676767676)) & 0x8080808080808080;
    const int count = std::countr_zero(others) / 8;
    if (count == 0) return p;
    number = number * kPowersOfTen[static_cast<std::size_t>(count)] +
             joined(digits << (8 * (8 - count)));
    p += count;
    if (count < 8) return p;
  }
  for (; p != end && is_digit(*p); ++p) number = 10 * number + static_cast<std::uint64_t>(*p - '0');
  return p;
}

const char* take_exponent(const char* p, const char* end, int& exponent) {
  constexpr std::ptrdiff_t kMost = 4;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  const char* const digits = p;
  for (; p != end && is_digit(*p) && p - digits < kMost; ++p) exponent = 10 * exponent + *p - '0';
  if (negative) exponent = -exponent;
  return p == digits || p - digits == kMost ? nullptr : p;
}

// mantissa / 10^power. The quotient of the leading bits has at least 63 bits, the last of which
// also says whether anything is left: rounding that to a double rounds the exact quotient.
double divide(std::uint64_t mantissa, int power) {
  const std::uint64_t five = kPowersOfFive[static_cast<std::size_t>(power)];
  const int up = std::countl_zero(mantissa), down = std::countl_zero(five);
  const Uint128 dividend = static_cast<Uint128>(mantissa << up) << 63;
  const std::uint64_t divisor = five << down;
  const auto quotient = static_cast<std::uint64_t>(dividend / divisor);
  const bool rest = quotient * static_cast<Uint128>(divisor) != dividend;
  const int exponent = down - up - 63 - power;
  const auto scale = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52);
  return static_cast<double>(quotient | static_cast<std::uint64_t>(rest)) * scale;
}

// mantissa * 10^exponent, where that is within reach of 64 bits.
bool scale(std::uint64_t mantissa, int exponent, double& value) {
  constexpr std::uint64_t kLargestExact = std::uint64_t{1} << 53;
  if (mantissa <= kLargestExact && std::abs(exponent) <= kMaxExactPower) {
    // Both are doubles: one operation rounds once (Clinger 1990).
    const double power = kExactPowersOfTen[static_cast<std::size_t>(std::abs(exponent))];
    value = exponent < 0 ? static_cast<double>(mantissa) / power
                         : static_cast<double>(mantissa) * power;
    return true;
  }
  if (mantissa == 0 || exponent > 0 || exponent < -kMaxPower) return false;
  value = divide(mantissa, -exponent);
  return true;
}

const char* take_quickly(const char* p, const char* end, double& value) {
  const bool negative = p != end && *p == '-';
  p += negative;  // no branches on signs: they are random
  std::uint64_t mantissa = 0;
  const char* const begin = p;
  while (p != end && is_digit(*p))
    mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t digits = p - begin;
  int exponent = 0;
  if (p != end && *p == '.') {
    const char* const decimals = ++p;
    p = take_digits(p, end, mantissa);
    digits += p - decimals;
    if (digits > kMaxDigits) return nullptr;
    exponent = static_cast<int>(decimals - p);
  }
  if (digits == 0 || digits > kMaxDigits) return nullptr;
  if (p != end && (*p == 'e' || *p == 'E')) {
    int written = 0;
    p = take_exponent(p + 1, end, written);
    exponent += written;
  }
  if (!p || !scale(mantissa, exponent, value)) return nullptr;
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^
                                static_cast<std::uint64_t>(negative) << 63);
  return p;
}

}  // namespace

const char* take_decimal(const char* p, const char* end, double& value) {
  if (const char* rest = take_quickly(p, end, value)) return rest;
  const auto [rest, status] = std::from_chars(p, end, value);
  return status == std::errc() && std::isfinite(value) ? rest : nullptr;
}

const char* take_decimal(const char* p, const char* end, std::uint64_t& value) {
  const char* const begin = p;
  std::uint64_t number = 0;
  while (p != end && is_digit(*p)) number = 10 * number + static_cast<std::uint64_t>(*p++ - '0');
  if (p != begin && p - begin <= kMaxDigits) {
    value = number;
    return p;
  }
  const auto [rest, status] = std::from_chars(begin, end, value);
  return status == std::errc() ? rest : nullptr;
}

}  // namespace cairn
