// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/table.hpp"

#include <cmath>
#include <cstdio>

namespace cairn::bench {
namespace {

void print_row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  std::puts(line.c_str());
  std::fflush(stdout);
}

std::string format(const char* pattern, int decimals, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, decimals, value);
  return text;
}

}  // namespace

Table::Table(const std::vector<std::string>& columns) {
  print_row(columns);
  print_row(std::vector<std::string>(columns.size(), "---"));
}

void Table::row(const std::vector<std::string>& cells) const { print_row(cells); }

std::string time_text(double seconds) {
  if (!std::isfinite(seconds)) return "never";
  if (seconds >= 1.0) return format("%.*f s", 2, seconds);
  const double ms = seconds * 1e3;
  return format("%.*f ms", ms >= 100.0 ? 0 : ms >= 10.0 ? 1 : 2, ms);
}

std::string ratio_text(double ratio) {
  return std::isfinite(ratio) ? format("%.*f x", 2, ratio) : "-";
}
std::string number_text(double value, int decimals) { return format("%.*f", decimals, value); }
std::string megabytes_text(double bytes) {
  return format("%.*f MB", bytes < 1e7 ? 1 : 0, bytes / 1e6);
}

}  // namespace cairn::bench
