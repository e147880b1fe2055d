// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/record_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "cairn/io/decimal.hpp"

namespace cairn {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
// Whether a field ends before `c`. What blanks are not is told by one comparison.
bool ends_field(char c, char separator) {
  return static_cast<unsigned char>(c) <= ' ' ? is_blank(c) : c == separator;
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* skip_blanks(const char* p, const char* end) {
  while (p != end && is_blank(*p)) ++p;
  return p;
}

// The first `c` from begin on, or end.
const char* find(char c, const char* begin, const char* end) {
  const auto length = static_cast<std::size_t>(end - begin);
  const void* found = length == 0 ? nullptr : std::memchr(begin, c, length);
  return found ? static_cast<const char*>(found) : end;
}

// Where a line's comment begins, a field that begins with '#', or its end.
const char* comment_in(const char* begin, const char* end) {
  const char* p = find('#', begin, end);
  while (p != end && p != begin && !is_blank(p[-1])) p = find('#', p + 1, end);
  return p;
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

// One field at `p`, which moves behind it; false sends the caller to the slow path that finds out
// why.
template <class Number>
bool take(const char*& p, const char* end, char separator, Number& value) {
  if (p != end && *p == '+') {
    ++p;
    if (p == end || !(is_digit(*p) || *p == '.')) return false;
  }
  p = take_decimal(p, end, value);
  if (!p || (p != end && !ends_field(*p, separator))) return false;
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

// Field by field, for the rare line with a number that the fast path does not take (1e-400).
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

const char* first_field(const Record& record, const char* end) {
  const char* p = skip_blanks(record.tag.data() + record.tag.size(), end);
  return record.separator != ' ' && p != end && *p == record.separator ? skip_blanks(p + 1, end)
                                                                       : p;
}

const char* take_ids(const Record& record, const char* end, std::span<std::uint64_t> ids) {
  const char* p = first_field(record, end);
  for (std::uint64_t& id : ids) {
    if (!take(p, end, record.separator, id)) return nullptr;
  }
  return p;
}

// Reads all numbers, or only the first `required` where the line ends there; how many. Nothing
// sends the caller to the slow path.
std::optional<std::size_t> read_fast(const Record& record, std::span<std::uint64_t> ids,
                                     std::span<double> numbers, std::size_t required) {
  const char* end = record.line.data() + record.line.size();
  const char* p = take_ids(record, end, ids);
  if (!p) return std::nullopt;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i == required && p == end) return required;
    if (!take(p, end, record.separator, numbers[i])) return std::nullopt;
  }
  return p == end ? std::optional(numbers.size()) : std::nullopt;
}

}  // namespace

RecordScanner::RecordScanner(std::string_view text, char separator, std::size_t first_line)
    : next_(text.data()),
      end_(text.data() + text.size()),
      hash_(find('#', next_, end_)),
      line_number_(first_line - 1),
      separator_(separator) {
  if (text.starts_with(kByteOrderMark)) next_ += kByteOrderMark.size();
}

bool RecordScanner::next(Record& record) {
  while (next_ != end_) {
    const char* begin = next_;
    const char* end = find('\n', begin, end_);
    next_ = end == end_ ? end : end + 1;
    ++line_number_;
    if (hash_ < begin) hash_ = find('#', begin, end_);
    if (hash_ < end) end = comment_in(begin, end);
    while (end != begin && is_blank(end[-1])) --end;
    const char* tag = skip_blanks(begin, end);
    if (tag == end) continue;
    const char* tag_end = tag;
    while (tag_end != end && !ends_field(*tag_end, separator_)) ++tag_end;
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
  while (next_ != end && !ends_field(*next_, separator)) ++next_;
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

bool read_ids(const Record& record, std::span<std::uint64_t> ids) {
  return take_ids(record, record.line.data() + record.line.size(), ids) != nullptr;
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

Result<std::size_t> read_fields(const Record& record, std::string_view file,
                                std::span<std::uint64_t> ids, std::span<double> numbers,
                                std::size_t required) {
  if (const auto count = read_fast(record, ids, numbers, required)) return *count;
  if (required < numbers.size() && count_fields(record) == ids.size() + required)
    numbers = numbers.first(required);
  if (read_slowly(record, ids, numbers)) return numbers.size();
  return explain(record, file, ids.size(), numbers.size());
}

Result<void> read_fields(const Record& record, std::string_view file, std::span<std::uint64_t> ids,
                         std::span<double> numbers) {
  const auto read = read_fields(record, file, ids, numbers, numbers.size());
  return read ? Result<void>() : read.error();
}

}  // namespace cairn
