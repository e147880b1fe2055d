// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace cairn::bench {

/// A Markdown table on standard output, row by row, so that a long run shows what it has.
class Table {
 public:
  explicit Table(const std::vector<std::string>& columns);
  void row(const std::vector<std::string>& cells) const;
};

/// "12.3 ms", "1.23 s"; "never" where not finite.
std::string time_text(double seconds);
/// "1.83 x".
std::string ratio_text(double ratio);
/// "0.83".
std::string number_text(double value, int decimals = 2);
/// "38 MB".
std::string megabytes_text(double bytes);

}  // namespace cairn::bench
