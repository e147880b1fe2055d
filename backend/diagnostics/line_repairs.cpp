// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/line_repairs.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace cairn {

CommaStyle find_comma_style(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t comma = text.find(','); comma != std::string_view::npos;
       comma = text.find(',', comma + 1)) {
    std::size_t before = 0, after = 0;
    while (before < comma && before < 4 && is_digit(text[comma - 1 - before])) ++before;
    while (comma + 1 + after < text.size() && after < 4 && is_digit(text[comma + 1 + after]))
      ++after;
    if (after == 0) continue;
    const bool leading_zero = before == 1 && text[comma - 1] == '0';
    if (after != 3 || before > 3 || leading_zero) return CommaStyle::kDecimal;
  }
  return CommaStyle::kUnclear;
}

std::string shortest(double number) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number);
  return {buffer, result.ptr};
}

std::string readable(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", number);
  return buffer;
}

void repair_decimal_commas(const Record& record, CommaStyle style, Repairs& repairs) {
  if (style != CommaStyle::kDecimal) return;
  std::vector<Repairs::Replacement> parts;
  FieldCursor fields(record);
  while (const auto field = fields.next()) {
    double number;
    const NumberFault fault = parse_number(field->text, number);
    if (fault == NumberFault::kNone) continue;
    if (fault != NumberFault::kDecimalComma) return;
    std::string text(field->text);
    std::replace(text.begin(), text.end(), ',', '.');
    parts.push_back({field->text, std::move(text)});
  }
  if (parts.empty()) return;
  const std::size_t count = parts.size();
  repairs.replace(
      CheckCode::kDecimalComma, record.line_number, parts,
      "wrote points for " + std::to_string(count) + " decimal comma" + (count == 1 ? "" : "s"));
}

void repair_full_matrix(const Record& record, const TagSpec& tag, std::size_t found,
                        Repairs& repairs) {
  const int n = tag.information;
  const int bare = tag.id_columns() + tag.measurement;
  if (n < 2 || found != static_cast<std::size_t>(bare + n * n) ||
      tag.layout == InformationLayout::kToro2 ||
      tag.layout == InformationLayout::kSquareRootFactor) {
    return;
  }
  FieldCursor fields(record);
  for (int k = 0; k < bare; ++k) fields.next();
  Eigen::MatrixXd omega(n, n);
  std::string_view first, last;
  for (int k = 0; k < n * n; ++k) {
    const auto field = fields.next();
    if (!field || parse_number(field->text, omega(k / n, k % n)) != NumberFault::kNone) return;
    if (k == 0) first = field->text;
    last = field->text;
  }
  const double asymmetry = (omega - omega.transpose()).cwiseAbs().maxCoeff();
  constexpr double kSlight = 1e-2;  // relative; more than that is another matrix, not rounding
  if (asymmetry > kSlight * omega.cwiseAbs().maxCoeff()) return;
  std::string triangle;
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c) {
      triangle += (triangle.empty() ? "" : " ") + shortest(0.5 * (omega(r, c) + omega(c, r)));
    }
  }
  const std::string_view part(first.data(),
                              static_cast<std::size_t>(last.data() + last.size() - first.data()));
  repairs.replace(CheckCode::kWrongCount, record.line_number, {{part, std::move(triangle)}},
                  asymmetry == 0.0
                      ? "kept the upper triangle of the information matrix"
                      : "made the information matrix symmetric and kept its upper triangle");
}

}  // namespace cairn
