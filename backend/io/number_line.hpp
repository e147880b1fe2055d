// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "cairn/io/record_scanner.hpp"

namespace cairn {

/// Lines of nothing but numbers, where the first field is no tag. Errors name file:line:column.
inline Error error_at(const Record& record, std::string_view file, std::size_t column,
                      std::string message) {
  return {ErrorCode::kBadInput, std::move(message), place_in(file, record.line_number, column)};
}

/// The line's fields; `expected` begins the error where there are more or fewer.
template <std::size_t kCount>
Result<std::array<Field, kCount>> split(const Record& record, std::string_view file,
                                        std::string_view expected) {
  const std::size_t found = count_fields(record) + 1;
  if (found != kCount) {
    return error_at(record, file, 1, std::string(expected) + ", found " + std::to_string(found));
  }
  std::array<Field, kCount> fields;
  fields[0] = {record.tag, record.column_of(record.tag.data())};
  FieldCursor cursor(record);
  for (std::size_t i = 1; i < kCount; ++i) fields[i] = *cursor.next();
  return fields;
}

/// A field as a finite number.
Result<double> number_in(const Field& field, const Record& record, std::string_view file);
/// A field as a time stamp in seconds, in ns.
Result<std::uint64_t> stamp_in(const Field& field, const Record& record, std::string_view file);

}  // namespace cairn
