// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "cairn/core/content_hash.hpp"

namespace cairn {

/// Appends numbers (little-endian) and texts to a byte string: what journal, spool and wire share.
class ByteWriter {
 public:
  explicit ByteWriter(std::string& bytes) : bytes_(bytes) {}

  template <std::integral Integer>
  void integer(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i);
  }
  void real(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
  void count(std::size_t value) { integer(static_cast<std::uint32_t>(value)); }
  void raw(std::string_view bytes) { bytes_ += bytes; }
  void hash(const ContentHash& hash) {
    raw({reinterpret_cast<const char*>(hash.data()), hash.size()});
  }
  /// A count of bytes (u32), then the bytes.
  void text(std::string_view bytes) {
    count(bytes.size());
    raw(bytes);
  }

 private:
  std::string& bytes_;
};

/// Reads what ByteWriter wrote, from bytes that nobody vouches for. The first thing that does not
/// fit is kept as `problem()`, with its `place()`; from then on everything reads as zero.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <std::integral Integer>
  Integer integer() {
    const std::string_view part = raw(sizeof(Integer));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(part[i])) << 8 * i;
    return static_cast<Integer>(value);
  }
  double real() { return std::bit_cast<double>(integer<std::uint64_t>()); }
  /// The next `size` bytes; none, and a problem, where fewer are left.
  std::string_view raw(std::size_t size) {
    if (size > left()) {
      fail("ends too early");
      return {};
    }
    position_ += size;
    return bytes_.substr(position_ - size, size);
  }
  ContentHash hash() {
    ContentHash hash{};
    const std::string_view bytes = raw(hash.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) hash[i] = static_cast<std::uint8_t>(bytes[i]);
    return hash;
  }
  /// How many things of at least `least_size` bytes each follow; a problem where so many cannot.
  std::size_t count(std::size_t least_size) {
    const auto count = integer<std::uint32_t>();
    if (count > left() / least_size) {
      fail("holds less than its count says");
      return 0;
    }
    return count;
  }
  std::string_view text() { return raw(count(1)); }
  /// An integer of an enumeration that runs from `first` to `last`.
  template <class Enum>
  Enum enumerator(Enum first, Enum last) {
    const auto value = integer<std::uint8_t>();
    if (value < static_cast<std::uint8_t>(first) || value > static_cast<std::uint8_t>(last)) {
      fail("has an unknown kind");
      return first;
    }
    return static_cast<Enum>(value);
  }

  void fail(std::string_view problem) {
    if (!problem_.empty()) return;
    problem_ = problem;
    place_ = position_;
    bytes_ = bytes_.substr(0, position_);
  }
  [[nodiscard]] bool ok() const { return problem_.empty(); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - position_; }
  [[nodiscard]] std::string_view problem() const { return problem_; }
  [[nodiscard]] std::size_t place() const { return ok() ? position_ : place_; }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
  std::string_view problem_;  // a literal
  std::size_t place_ = 0;
};

}  // namespace cairn
