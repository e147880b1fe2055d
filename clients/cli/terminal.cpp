// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <sstream>

namespace cairn::cli {
namespace {

// The first so many characters; a byte that continues one does not count.
std::string first_characters(const std::string& line, std::size_t count) {
  std::size_t end = 0;
  for (std::size_t characters = 0; end < line.size(); ++end) {
    const bool begins = (static_cast<unsigned char>(line[end]) & 0xC0) != 0x80;
    if (begins && characters++ == count) break;
  }
  return line.substr(0, end);
}

}  // namespace

CharacterGrid terminal_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row < 2 || size.ws_col < 2) return {};
  return {size.ws_col, size.ws_row};
}

// What is left of the last one is cleared behind each line; a terminal that scrolls would keep it.
void draw_in_place(const std::string& text) {
  const CharacterGrid size = terminal_size();
  std::istringstream lines(text);
  std::string all = "\x1b[H", line;
  for (std::size_t row = 1; row < size.rows && std::getline(lines, line); ++row)
    all += first_characters(line, size.columns) + "\x1b[K\n";
  std::fputs((all + "\x1b[J").c_str(), stdout);
}

}  // namespace cairn::cli
