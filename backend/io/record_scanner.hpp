// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cairn/core/result.hpp"

namespace cairn {

/// One field of a line and its column (bytes, from 1).
struct Field {
  std::string_view text;
  std::size_t column = 0;
};

/// One line of a graph file that is neither blank nor a comment. Views into the scanned text.
struct Record {
  std::string_view line;        ///< without line end, trailing blanks and trailing comment
  std::size_t line_number = 0;  ///< from 1
  std::string_view tag;         ///< the first field
  char separator = ' ';         ///< separates fields beside blanks and tabs

  /// Column (from 1) of a place within `line`.
  [[nodiscard]] std::size_t column_of(const char* place) const {
    return static_cast<std::size_t>(place - line.data()) + 1;
  }
};

/// Walks the lines of a text: skips a byte order mark, blank lines and comments (from a field that
/// begins with '#' to the end of the line), and takes LF and CRLF alike. Allocates nothing.
class RecordScanner {
 public:
  explicit RecordScanner(std::string_view text, char separator = ' ', std::size_t first_line = 1);

  /// False at the end of the text.
  bool next(Record& record);

 private:
  const char* next_;
  const char* end_;
  const char* hash_;  // the first '#' not yet passed
  std::size_t line_number_;
  char separator_;
};

/// Walks the fields behind the tag.
class FieldCursor {
 public:
  explicit FieldCursor(const Record& record);

  /// Nothing at the end of the line. With ',' as separator an empty field is a field.
  std::optional<Field> next();

 private:
  const Record* record_;
  const char* next_;
};

[[nodiscard]] std::size_t count_fields(const Record& record);
/// The index-th field behind the tag, from 0.
[[nodiscard]] std::optional<Field> field_at(const Record& record, std::size_t index);

/// The first ids.size() fields behind the tag as ids; false where one is none. Faster than a
/// cursor.
bool read_ids(const Record& record, std::span<std::uint64_t> ids);

/// Why a field is not the number it should be.
enum class NumberFault : std::uint8_t {
  kNone,
  kNotFinite,     ///< inf or nan
  kDecimalComma,  ///< 1,5
  kHexadecimal,   ///< 0x1F
  kOutOfRange,    ///< beyond the largest double, or the largest id
  kNotANumber,
};

/// The whole field as a finite decimal number: `8.85e+001`, `+1`, `.5` and `1.` are numbers.
NumberFault parse_number(std::string_view text, double& value);
/// The whole field as an id: digits only (a leading '+' passes), below 2^64.
NumberFault parse_id(std::string_view text, std::uint64_t& id);
/// The whole field as a signed parameter id.
NumberFault parse_id(std::string_view text, std::int64_t& id);

/// "'1,5' has a decimal comma; write 1.5", "'-3' is not an id (a whole number from 0 to 2^64 - 1)".
std::string describe_number_fault(NumberFault fault, std::string_view text);
std::string describe_id_fault(std::string_view text);

/// Text from a file as it may appear in a message: at most 40 bytes, anything unprintable as \xNN.
std::string quote(std::string_view text);

/// "name:line:column".
std::string place_in(std::string_view name, std::size_t line, std::size_t column);

/// Reads exactly ids.size() ids followed by numbers.size() numbers from behind the tag. The error
/// names line and column: "file:312:1: EDGE_SE2 expects 11 numbers, found 9", "file:4:17: 'nan' is
/// not a finite number".
Result<void> read_fields(const Record& record, std::string_view file, std::span<std::uint64_t> ids,
                         std::span<double> numbers);
/// The same where the numbers behind the first `required` may be left out together. How many there
/// are.
Result<std::size_t> read_fields(const Record& record, std::string_view file,
                                std::span<std::uint64_t> ids, std::span<double> numbers,
                                std::size_t required);

}  // namespace cairn
