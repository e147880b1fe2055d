// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace cairn::test {

/// Resident memory of a process, MB; 0 where there is none.
inline double resident_mb(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string word;
  while (status >> word) {
    if (word != "VmRSS:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1024.0;
  }
  return 0.0;
}

/// Slope of y over x by least squares.
inline double slope(const std::vector<std::pair<double, double>>& points) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const auto& [a, b] : points) n += 1.0, x += a, y += b, xx += a * a, xy += a * b;
  const double spread = n * xx - x * x;
  return spread > 0.0 ? (n * xy - x * y) / spread : 0.0;
}

}  // namespace cairn::test
