// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/utf8.hpp"

#include <cstdint>

namespace cairn::drawing {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// Length of the valid character at the front, 0 where there is none (RFC 3629: shortest form, no
// surrogates).
std::size_t character_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0 || length > text.size()) return 0;
  std::uint32_t code = length == 1 ? first : first & (0x7Fu >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if (!is_continuation(text[k])) return 0;
    code = code << 6 | (static_cast<unsigned char>(text[k]) & 0x3Fu);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  const bool control = code < 0x20 || code == 0x7F || code == 0xFFFE || code == 0xFFFF;
  return overlong || surrogate || control || code > 0x10FFFF ? 0 : length;
}

}  // namespace

std::string printable_utf8(std::string_view text) {
  std::string printable;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    length == 0 ? printable.append("?") : printable.append(text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return printable;
}

std::string shortened(std::string_view text, std::size_t characters) {
  const std::string printable = printable_utf8(text);
  std::size_t count = 0;
  for (const char c : printable) count += is_continuation(c) ? 0 : 1;
  if (count <= characters) return printable;
  const std::size_t head = characters / 2, tail = characters - head - 1;
  std::string front, back;
  std::size_t index = 0;
  for (const char c : printable) {
    index += is_continuation(c) ? 0 : 1;
    if (index <= head) front += c;
    if (index > count - tail) back += c;
  }
  return front + "\u2026" + back;
}

}  // namespace cairn::drawing
