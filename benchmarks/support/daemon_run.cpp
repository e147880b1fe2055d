// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/daemon_run.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "cairn/core/stopwatch.hpp"

namespace cairn::bench {

double percentile_ms(std::vector<double>& seconds, double part) {
  if (seconds.empty()) return NAN;
  std::sort(seconds.begin(), seconds.end());
  return 1e3 * seconds[static_cast<std::size_t>(part * static_cast<double>(seconds.size() - 1))];
}

double fdatasync_p50_ms(const std::filesystem::path& folder) {
  const std::string block(600, 'x'), name = folder / "fdatasync";
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::vector<double> seconds;
  for (int i = 0; i < 500; ++i) {
    const Stopwatch watch;
    if (write(file, block.data(), block.size()) < 0 || fdatasync(file) < 0) break;
    seconds.push_back(watch.seconds());
  }
  close(file);
  return percentile_ms(seconds, 0.5);
}

std::filesystem::path fresh_folder(const std::string& name) {
  const char* given = std::getenv("DAEMON_FOLDER");
  const std::filesystem::path folder = std::filesystem::path(given ? given : ".") / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace cairn::bench
