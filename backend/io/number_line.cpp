// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/number_line.hpp"

#include "cairn/io/time_stamp.hpp"

namespace cairn {

Result<double> number_in(const Field& field, const Record& record, std::string_view file) {
  double value;
  const NumberFault fault = parse_number(field.text, value);
  if (fault == NumberFault::kNone) return value;
  return error_at(record, file, field.column, describe_number_fault(fault, field.text));
}

Result<std::uint64_t> stamp_in(const Field& field, const Record& record, std::string_view file) {
  const Result<double> seconds = number_in(field, record, file);
  if (!seconds) return seconds.error();
  if (const auto stamp = parse_stamp_ns(field.text)) return *stamp;
  return error_at(record, file, field.column, describe_stamp_fault(field.text));
}

}  // namespace cairn
