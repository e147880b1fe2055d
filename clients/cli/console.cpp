// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/console.hpp"

#include <unistd.h>

namespace cairn::cli {

void Console::say(const std::string& line) const {
  if (quiet_) return;
  std::fprintf(stream_, "%s\n", line.c_str());
  std::fflush(stream_);  // who reads the pipe wants to see it now
}

void Console::warn(const std::string& line) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::show_progress(const std::string& line) const {
  if (quiet_ || isatty(fileno(stream_)) == 0) return;
  constexpr const char* kStartOfLine = "\r\x1b[K";
  std::fprintf(stream_, "%s%s", kStartOfLine, line.c_str());
  std::fflush(stream_);
}

}  // namespace cairn::cli
