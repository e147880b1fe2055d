// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

#include "cairn/diagnostics/repairs.hpp"
#include "cairn/io/graph_tags.hpp"
#include "cairn/io/record_scanner.hpp"

namespace cairn {

/// What a comma inside a number means in this file.
enum class CommaStyle {
  kDecimal,  ///< at least one can only be a decimal comma (1,25)
  kUnclear,  ///< all could as well separate thousands (1,250)
};
CommaStyle find_comma_style(std::string_view text);

/// The shortest text that reads back as the same number.
std::string shortest(double number);
/// Four significant digits, for messages.
std::string readable(double number);

/// Writes points for decimal commas, where their meaning is clear and every field becomes a number.
void repair_decimal_commas(const Record& record, CommaStyle style, Repairs& repairs);

/// Where a line ends with all N x N numbers of a (nearly) symmetric information, keeps the upper
/// triangle.
void repair_full_matrix(const Record& record, const TagSpec& tag, std::size_t found,
                        Repairs& repairs);

}  // namespace cairn
