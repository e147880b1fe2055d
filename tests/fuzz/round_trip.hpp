// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "cairn/io/graph_file.hpp"

namespace cairn::fuzz {

inline void require(bool condition, const char* what, const std::string& text) {
  if (condition) return;
  std::fprintf(stderr, "%s\n%s\n", what, text.c_str());
  std::abort();
}

/// What a reader accepts must be written so that it reads back, and from the second writing on
/// stand still byte for byte. What it refuses must have a place and a reason.
inline void check_text(std::string_view text, GraphFormat format) {
  const ReadOptions options{.format = format};
  const auto first = read_graph_text(text, "fuzz", options);
  if (!first) {
    require(!first.error().place.empty() && !first.error().message.empty(),
            "an error without place", "");
    return;
  }
  auto written = write_graph_text(*first, format);
  for (int round = 0; round < 2 && written; ++round) {
    const auto again = read_graph_text(*written, "fuzz", options);
    require(again.ok(), "what was written does not read back", *written);
    const auto rewritten = write_graph_text(*again, format);
    require(rewritten.ok(), "what was read back is not written", *written);
    if (round == 1)
      require(*rewritten == *written, "the text does not stand still",
              *written + "---\n" + *rewritten);
    written = rewritten;
  }
}

}  // namespace cairn::fuzz
