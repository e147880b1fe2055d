// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/map_text.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

MapImage some_map() {
  using enum CellState;
  return {0.1,
          Se2(-1.5, 2.25, 0.0),
          4,
          2,
          {kUnknown, kFree, kFree, kFree, kFree, kOccupied, kOccupied, kUnknown}};
}

std::string header() {
  const std::string text = to_text(some_map());
  return text.substr(0, text.find('\n') + 1);
}

TEST(MapText, IsReadAsItWasWritten) {
  EXPECT_EQ(to_text(some_map()).substr(header().size()), "?4.2#?");
  const Result<MapImage> read = parse_map_text(to_text(some_map()));
  ASSERT_TRUE(read.ok()) << read.error().to_string();
  EXPECT_EQ(read->cells, some_map().cells);
  EXPECT_EQ(read->width, 4u);
  EXPECT_EQ(read->height, 2u);
  EXPECT_EQ(read->resolution_m, 0.1);
  EXPECT_EQ(read->T_map_image.to_vector(), some_map().T_map_image.to_vector());
}

TEST(MapText, RefusesWhatIsNone) {
  const std::string text = to_text(some_map());
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_FALSE(parse_map_text(text.substr(0, size)).ok()) << size;
  for (const char* cells : {"9?", "8", "7?x", "99999999999999999999?", "-8?", "8?8?", "7?#."})
    EXPECT_FALSE(parse_map_text(header() + cells).ok()) << cells;
  for (const char* line : {"", "{}", "[]", R"({"width":99999999999,"height":99999999999})",
                           R"({"width":1,"height":1,"resolution_m":-1,"origin":[0,0,0]})",
                           R"({"width":1,"height":1,"resolution_m":1,"origin":[0,0,"a"]})",
                           R"({"width":1,"height":1,"resolution_m":1,"origin":5})"})
    EXPECT_FALSE(parse_map_text(std::string(line) + "\n?").ok()) << line;
}

}  // namespace
}  // namespace cairn
