// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace cairn::test {

/// Resident memory of a process, MB of 10^6 bytes; 0 where there is none.
inline double resident_mb(pid_t process) {
  std::ifstream statistics("/proc/" + std::to_string(process) + "/statm");
  double all = 0, resident = 0;
  statistics >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// User and system time of a process, s.
inline double cpu_seconds(pid_t process) {
  std::ifstream statistics("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  double ticks = 0;
  for (int i = 1; i <= 15 && statistics >> word; ++i) {
    if (i >= 14) ticks += std::strtod(word.c_str(), nullptr);
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace cairn::test
