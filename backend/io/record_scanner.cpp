// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/record_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace cairn {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* skip_blanks(const char* p, const char* end) {
  while (p != end && is_blank(*p)) ++p;
  return p;
}

// The end of a line's content: before a field that begins with '#', and before trailing blanks.
const char* content_end(const char* begin, const char* end) {
  const char* p = begin;
  while (p != end) {
    p = static_cast<const char*>(std::memchr(p, '#', static_cast<std::size_t>(end - p)));
    if (!p) break;
    if (p == begin || is_blank(p[-1])) {
      end = p;
      break;
    }
    ++p;
  }
  while (end != begin && is_blank(end[-1])) --end;
  return end;
}

std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && (is_digit(text[1]) || text[1] == '.');
  return plus ? text.substr(1) : text;
}

bool has_decimal_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find(',', comma + 1) != std::string_view::npos)
    return false;
  std::string repaired(text);
  repaired[comma] = '.';
  double value;
  return parse_number(repaired, value) == NumberFault::kNone;
}

bool is_hexadecimal(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
}

template <class Integer>
NumberFault parse_integer(std::string_view text, Integer& id) {
  text = without_plus(text);
  const char* end = text.data() + text.size();
  const auto [rest, status] = std::from_chars(text.data(), end, id);
  if (status == std::errc::result_out_of_range) return NumberFault::kOutOfRange;
  return status == std::errc() && rest == end ? NumberFault::kNone : NumberFault::kNotANumber;
}

// The number at `p` in the form most files have, digits with a point and no exponent: exact,
// because an integer below 2^53 and a power of ten up to 10^22 are doubles (Clinger 1990). Null for
// others.
const char* take_short_decimal(const char* p, const char* end, double& value) {
  constexpr int kMaxDigits = 15;
  constexpr double kPowersOfTen[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool negative = p != end && *p == '-';
  if (negative) ++p;
  std::uint64_t mantissa = 0;
  const char* const digits = p;
  while (p != end && is_digit(*p))
    mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t count = p - digits, decimals = 0;
  if (p != end && *p == '.') {
    const char* const point = p++;
    while (p != end && is_digit(*p))
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
    decimals = p - point - 1;
    count += decimals;
  }
  if (count == 0 || count > kMaxDigits) return nullptr;
  value = static_cast<double>(mantissa) / kPowersOfTen[decimals];
  if (negative) value = -value;
  return p;
}

const char* take_number(const char* p, const char* end, std::uint64_t& id) {
  const auto [rest, status] = std::from_chars(p, end, id);
  return status == std::errc() ? rest : nullptr;
}

const char* take_number(const char* p, const char* end, double& value) {
  const char* rest = take_short_decimal(p, end, value);
  if (rest && (rest == end || (*rest != 'e' && *rest != 'E'))) return rest;
  const auto [long_rest, status] = std::from_chars(p, end, value);
  return status == std::errc() && std::isfinite(value) ? long_rest : nullptr;
}

// One field at `p`, which moves behind it; false sends the caller to the slow path that finds out
// why.
template <class Number>
bool take(const char*& p, const char* end, char separator, Number& value) {
  if (p != end && *p == '+') {
    ++p;
    if (p == end || !(is_digit(*p) || *p == '.')) return false;
  }
  p = take_number(p, end, value);
  if (!p || (p != end && !is_blank(*p) && *p != separator)) return false;
  p = skip_blanks(p, end);
  if (p == end || separator == ' ' || *p != separator) return true;
  p = skip_blanks(p + 1, end);
  return p != end;
}

Error count_error(const Record& record, std::string_view file, std::size_t expected) {
  return {ErrorCode::kBadInput,
          quote(record.tag) + " expects " + std::to_string(expected) + " numbers, found " +
              std::to_string(count_fields(record)),
          place_in(file, record.line_number, 1)};
}

// Why the fast path failed: the first field that is wrong, or the wrong number of fields.
Error explain(const Record& record, std::string_view file, std::size_t id_count,
              std::size_t number_count) {
  if (count_fields(record) != id_count + number_count)
    return count_error(record, file, id_count + number_count);
  FieldCursor fields(record);
  for (std::size_t i = 0; i < id_count + number_count; ++i) {
    const Field field = *fields.next();
    std::uint64_t id;
    double number;
    const NumberFault fault =
        i < id_count ? parse_id(field.text, id) : parse_number(field.text, number);
    if (fault == NumberFault::kNone) continue;
    return {ErrorCode::kBadInput,
            i < id_count ? describe_id_fault(field.text) : describe_number_fault(fault, field.text),
            place_in(file, record.line_number, field.column)};
  }
  CAIRN_CHECK(false, "a line failed to parse, but each of its fields parses");
}

// Field by field, for the rare line with numbers that from_chars alone does not take (1e-400).
bool read_slowly(const Record& record, std::span<std::uint64_t> ids, std::span<double> numbers) {
  FieldCursor fields(record);
  for (std::uint64_t& id : ids) {
    const auto field = fields.next();
    if (!field || parse_id(field->text, id) != NumberFault::kNone) return false;
  }
  for (double& number : numbers) {
    const auto field = fields.next();
    if (!field || parse_number(field->text, number) != NumberFault::kNone) return false;
  }
  return !fields.next();
}

bool read_fast(const Record& record, std::span<std::uint64_t> ids, std::span<double> numbers) {
  const char* end = record.line.data() + record.line.size();
  const char* p = skip_blanks(record.tag.data() + record.tag.size(), end);
  if (record.separator != ' ' && p != end && *p == record.separator) p = skip_blanks(p + 1, end);
  for (std::uint64_t& id : ids) {
    if (!take(p, end, record.separator, id)) return false;
  }
  for (double& number : numbers) {
    if (!take(p, end, record.separator, number)) return false;
  }
  return p == end;
}

}  // namespace

RecordScanner::RecordScanner(std::string_view text, char separator)
    : next_(text.data()), end_(text.data() + text.size()), separator_(separator) {
  if (text.starts_with(kByteOrderMark)) next_ += kByteOrderMark.size();
}

bool RecordScanner::next(Record& record) {
  while (next_ != end_) {
    const char* begin = next_;
    const auto* newline =
        static_cast<const char*>(std::memchr(begin, '\n', static_cast<std::size_t>(end_ - begin)));
    next_ = newline ? newline + 1 : end_;
    ++line_number_;
    const char* end = content_end(begin, newline ? newline : end_);
    const char* tag = skip_blanks(begin, end);
    if (tag == end) continue;
    const char* tag_end = tag;
    while (tag_end != end && !is_blank(*tag_end) && *tag_end != separator_) ++tag_end;
    record.line = {begin, static_cast<std::size_t>(end - begin)};
    record.line_number = line_number_;
    record.tag = {tag, static_cast<std::size_t>(tag_end - tag)};
    record.separator = separator_;
    return true;
  }
  return false;
}

FieldCursor::FieldCursor(const Record& record)
    : record_(&record), next_(record.tag.data() + record.tag.size()) {}

std::optional<Field> FieldCursor::next() {
  const char* end = record_->line.data() + record_->line.size();
  next_ = skip_blanks(next_, end);
  if (next_ == end) return std::nullopt;
  const char separator = record_->separator;
  if (separator != ' ' && *next_ == separator) next_ = skip_blanks(next_ + 1, end);
  const char* begin = next_;
  while (next_ != end && !is_blank(*next_) && *next_ != separator) ++next_;
  return Field{{begin, static_cast<std::size_t>(next_ - begin)}, record_->column_of(begin)};
}

std::size_t count_fields(const Record& record) {
  FieldCursor fields(record);
  std::size_t count = 0;
  while (fields.next()) ++count;
  return count;
}

std::optional<Field> field_at(const Record& record, std::size_t index) {
  FieldCursor fields(record);
  std::optional<Field> field = fields.next();
  for (; field && index > 0; --index) field = fields.next();
  return field;
}

NumberFault parse_number(std::string_view text, double& value) {
  const std::string_view digits = without_plus(text);
  const char* end = digits.data() + digits.size();
  const auto [rest, status] = std::from_chars(digits.data(), end, value);
  if (status == std::errc::result_out_of_range && rest == end) {
    value =
        std::strtod(std::string(digits).c_str(), nullptr);  // 1e-400 is 0, 1e400 is not a number
    return std::isfinite(value) ? NumberFault::kNone : NumberFault::kOutOfRange;
  }
  if (status == std::errc() && rest == end)
    return std::isfinite(value) ? NumberFault::kNone : NumberFault::kNotFinite;
  if (has_decimal_comma(text)) return NumberFault::kDecimalComma;
  return is_hexadecimal(text) ? NumberFault::kHexadecimal : NumberFault::kNotANumber;
}

NumberFault parse_id(std::string_view text, std::uint64_t& id) { return parse_integer(text, id); }
NumberFault parse_id(std::string_view text, std::int64_t& id) { return parse_integer(text, id); }

std::string describe_number_fault(NumberFault fault, std::string_view text) {
  const std::string quoted = "'" + quote(text) + "'";
  switch (fault) {
    case NumberFault::kNotFinite:
      return quoted + " is not a finite number";
    case NumberFault::kDecimalComma: {
      std::string repaired(text);
      std::replace(repaired.begin(), repaired.end(), ',', '.');
      return quoted + " has a decimal comma; write " + quote(repaired);
    }
    case NumberFault::kHexadecimal:
      return quoted + " is hexadecimal; write a decimal number";
    case NumberFault::kOutOfRange:
      return quoted + " is beyond the largest number (1.8e308)";
    default:
      return quoted + " is not a number";
  }
}

std::string describe_id_fault(std::string_view text) {
  return "'" + quote(text) + "' is not an id (a whole number from 0 to 18446744073709551615)";
}

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string quoted;
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) {
      quoted += c;
    } else {
      quoted += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return text.size() > kLongest ? quoted + "..." : quoted;
}

std::string place_in(std::string_view name, std::size_t line, std::size_t column) {
  return std::string(name) + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Result<void> read_fields(const Record& record, std::string_view file, std::span<std::uint64_t> ids,
                         std::span<double> numbers) {
  if (read_fast(record, ids, numbers) || read_slowly(record, ids, numbers)) return {};
  return explain(record, file, ids.size(), numbers.size());
}

}  // namespace cairn
