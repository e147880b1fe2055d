// SPDX-License-Identifier: BSD-3-Clause
// Every malformed input gets one exact message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/io/compression.hpp"
#include "cairn/io/graph_reader.hpp"
#include "cairn/io/graph_tags.hpp"

namespace cairn {
namespace {

std::string message_of(std::string_view text, const ReadOptions& options = {}) {
  const auto document = read_graph_text(text, "f", options);
  return document ? "accepted" : document.error().to_string();
}

constexpr GraphFormat kTextFormats[] = {GraphFormat::kG2o, GraphFormat::kToro, GraphFormat::kIsam};

// A first line that makes the text a graph, so that the second is the one in question.
std::string sound_line(GraphFormat format) {
  if (format == GraphFormat::kG2o) return "VERTEX_SE2 0 0 0 0\n";
  return format == GraphFormat::kToro ? "VERTEX2 0 0 0 0\n" : "ODOMETRY 0 1 1 0 0 1 0 0 1 0 1\n";
}

std::string line_of(const TagSpec& tag, int fields, int changed = -1,
                    const std::string& change = "") {
  std::string line(tag.name);
  for (int i = 0; i < fields; ++i) line += " " + (i == changed ? change : "1");
  return line;
}

// Calls test(format, tag) for every tag with a fixed number of columns.
template <class Test>
void for_each_tag(Test test) {
  for (const GraphFormat format : kTextFormats) {
    for (const TagSpec& tag : graph_tags(format)) {
      if (tag.role != TagRole::kFix && &tag == find_tag(format, tag.name)) test(format, tag);
    }
  }
}

TEST(Malformed, EveryTagTellsHowManyNumbersItExpects) {
  for_each_tag([](GraphFormat format, const TagSpec& tag) {
    for (const int fields : {0, tag.columns() - 1, tag.columns() + 1}) {
      EXPECT_EQ(message_of(sound_line(format) + line_of(tag, fields), {.format = format}),
                "f:2:1: " + std::string(tag.name) + " expects " + std::to_string(tag.columns()) +
                    " numbers, found " + std::to_string(fields));
    }
  });
}

TEST(Malformed, EveryColumnOfEveryTagTellsWhatIsNoNumber) {
  for_each_tag([](GraphFormat format, const TagSpec& tag) {
    for (int i = 0; i < tag.columns(); ++i) {
      const std::string place =
          "f:2:" + std::to_string(tag.name.size() + 2 + 2 * static_cast<std::size_t>(i)) + ": ";
      const bool is_id = i < tag.id_columns();
      EXPECT_EQ(
          message_of(sound_line(format) + line_of(tag, tag.columns(), i, "nan"),
                     {.format = format}),
          place + (is_id ? "'nan' is not an id (a whole number from 0 to 18446744073709551615)"
                         : "'nan' is not a finite number"));
    }
  });
}

struct Case {
  std::string text, message;
};
class MalformedText : public testing::TestWithParam<Case> {};
TEST_P(MalformedText, GetsOneExactMessage) {
  EXPECT_EQ(message_of(GetParam().text), GetParam().message);
}

const std::string kPoses = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_XY 2 2 0\n";
const std::string kNoTag = " is not a tag; a line begins with a tag such as VERTEX_SE2";
INSTANTIATE_TEST_SUITE_P(
    Texts, MalformedText,
    testing::Values(
        Case{"", "f:1:1: the file is empty"},
        Case{"\n# only a comment\n", "f:1:1: the file is empty"},
        Case{"hello world\n",
             "f:1:1: not a graph file: no line begins with a known tag, this one begins with "
             "'hello'"},
        Case{std::string("\x7F\x45LF\x00\x01", 6),
             "f:1:1: not a graph file: no line begins with a known tag, this one begins with "
             "'\\x7FELF\\x00\\x01'"},
        Case{kPoses + "1 2 3\n", "f:4:1: '1'" + kNoTag},
        Case{kPoses + "  \x80\x81\n", "f:4:3: '\\x80\\x81'" + kNoTag},
        Case{
            "FIX 0\n",
            "f:1:1: not a graph file: no line begins with a known tag, this one begins with 'FIX'"},
        Case{kPoses + "VERTEX_SE2 1 0 0 0\n", "f:4:12: vertex 1 is defined twice, first in line 2"},
        Case{kPoses + "VERTEX_XY 1 0 0\n", "f:4:11: vertex 1 is defined twice, first in line 2"},
        Case{kPoses + "EDGE_SE2 0 9 0 0 0 1 0 0 1 0 1\n",
             "f:4:12: vertex 9 is not defined; add its VERTEX_SE2 line, or leave out all "
             "VERTEX_SE2 lines to start "
             "from the edges"},
        Case{kPoses + "EDGE_SE2 0 2 0 0 0 1 0 0 1 0 1\n",
             "f:4:12: vertex 2 is a 2-D point, but EDGE_SE2 needs a SE(2) pose"},
        Case{kPoses + "EDGE_SE2 1 1 0 0 0 1 0 0 1 0 1\n",
             "f:4:12: EDGE_SE2 connects vertex 1 with itself"},
        Case{kPoses + "EDGE_SE2 0 1 0 0 0 1 2 0 1 0 1\n",
             "f:4:20: EDGE_SE2 information is not positive semidefinite; 'cairn check' tells its "
             "smallest eigenvalue "
             "and repairs it with --fix"},
        Case{kPoses + "EDGE_SE2_POINTXY_OFFSET 0 2 7 0 0 1 0 1\n",
             "f:4:29: parameter 7 is not defined; add its PARAMS_SE2OFFSET line"},
        Case{kPoses + "PARAMS_SE2OFFSET 7 0 0 0\nPARAMS_SE2OFFSET 7 0 0 1\n",
             "f:5:18: parameter 7 is defined twice"},
        Case{kPoses + "PARAMS_SE2OFFSET 18446744073709551615 0 0 0\n",
             "f:4:18: the parameter id is beyond 2^63 - 1"},
        Case{kPoses + "FIX\n", "f:4:1: FIX expects 1 or more vertex ids, found 0"},
        Case{kPoses + "FIX 0 9\n", "f:4:7: vertex 9 is not defined"},
        Case{kPoses + "FIX 0 -1\n",
             "f:4:7: '-1' is not an id (a whole number from 0 to 18446744073709551615)"},
        Case{kPoses + "EQUIV 8 9\n", "f:4:7: vertex 8 is not defined"},
        Case{"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 0\n",
             "f:1:25: the quaternion has no direction; expected qx qy qz qw of length 1"},
        Case{"EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2_XY 1 0 1 1 1 0 1\n",
             "f:2:15: vertex 0 is a SE(2) pose, but EDGE_SE2_XY needs a 2-D point"},
        Case{"VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 0",
             "f:2:1: EDGE_SE2 expects 11 numbers, found 5"}));

TEST(Malformed, ALineThatClaimsVeryManyValuesIsCountedNotStored) {
  std::string text = kPoses + "EDGE_SE2";
  for (int i = 0; i < 1'000'000; ++i) text += " 1";
  EXPECT_EQ(message_of(text), "f:4:1: EDGE_SE2 expects 11 numbers, found 1000000");
  EXPECT_EQ(message_of(kPoses + "EDGE_SE2 0 1000000000000 1 0 0 1 0 0 1 0 1"),
            "f:4:12: vertex 1000000000000 is not defined; add its VERTEX_SE2 line, or leave out "
            "all VERTEX_SE2 lines "
            "to start from the edges");
}

TEST(Malformed, AVeryLongLineWithoutEndIsQuotedShort) {
  EXPECT_EQ(message_of(std::string(10'000'000, 'x')),
            "f:1:1: not a graph file: no line begins with a known tag, this one begins with '" +
                std::string(40, 'x') + "...'");
}

TEST(Malformed, AChainOfEquivalencesIsFollowedQuickly) {
  std::string text = "VERTEX_SE2 0 0 0 0\n";
  for (int i = 0; i < 200'000; ++i)
    text += "EQUIV " + std::to_string(i + 1) + " " + std::to_string(i) + "\n";
  const auto document = read_graph_text(text, "f");
  ASSERT_TRUE(document) << document.error().to_string();
  EXPECT_EQ(document->graph.variables().size(), 1u);
}

TEST(Malformed, DlrFilesTellWhatTheyExpect) {
  const auto message = [](std::string_view vertices, std::string_view state,
                          std::string_view edges) {
    const auto document = read_dlr_texts({{"v", vertices}, {"s", state}, {"e", edges}});
    return document ? "accepted" : document.error().to_string();
  };
  const std::string two = "0,0,3\n7,3,3\n", state = "0\n0\n0\n1\n0\n0\n";
  EXPECT_EQ(message(two, state, "P,0,7,1,0,0,1,0,0,0,1,0,0,0,1\n"), "accepted");
  EXPECT_EQ(message(two, state, "P,0,7,1,0,0,1,0,0,0,1,0,0,0\n"),
            "e:1:1: P expects 14 numbers, found 13");
  EXPECT_EQ(message(two, state, "P,0,7,1,0,,1,0,0,0,1,0,0,0,1\n"), "e:1:11: '' is not a number");
  EXPECT_EQ(message(two, state, "Q,0,7\n"), "e:1:1: 'Q' is not a kind of edge; expected P or L");
  EXPECT_EQ(message(two, state, "P,0,7,1,0,0,1,2,0,0,1,0,0,0,1\n"),
            "e:1:13: the information matrix is not symmetric");
  EXPECT_EQ(message(two, state, "P,0,8,1,0,0,1,0,0,0,1,0,0,0,1\n"),
            "e:1:3: factor refers to variable 8, which is not defined");
  EXPECT_EQ(message("0,5,3\n", state, ""), "v:1:3: offset 5 points behind the state of 6 numbers");
  EXPECT_EQ(message("0,18446744073709551615,3\n", state, ""),
            "v:1:3: offset 18446744073709551615 points behind the state of 6 numbers");
  EXPECT_EQ(message("0,0,4\n", state, ""),
            "v:1:5: dimension 4; expected 3 (a pose) or 2 (a landmark)");
  EXPECT_EQ(message("0,0,3\n0,3,3\n", state, ""), "v:2:1: vertex 0 is defined twice");
  EXPECT_EQ(message(two, "0\nx\n", ""), "s:2:1: 'x' is not a number");
}

TEST(Compression, GivesBackWhatWentIn) {
  const std::string text(3'000'000, 'a');
  for (const Compression compression : {Compression::kGzip, Compression::kBzip2}) {
    const std::string packed = compress(text, compression);
    EXPECT_EQ(recognize_compression(packed), compression);
    EXPECT_EQ(*decompress(packed, compression, "f", text.size()), text);
    EXPECT_EQ(*decompress(packed + packed, compression, "f", 2 * text.size()), text + text)
        << "two members";
  }
}

TEST(Compression, RefusesTruncatedDamagedAndOversizedData) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) text += std::to_string(i * i) + "\n";
  for (const Compression compression : {Compression::kGzip, Compression::kBzip2}) {
    const std::string packed = compress(text, compression);
    const auto message = [&](const std::string& bytes, std::size_t limit) {
      const auto result = decompress(bytes, compression, "f", limit);
      return result ? "accepted" : result.error().to_string();
    };
    EXPECT_EQ(message(packed.substr(0, packed.size() / 2), text.size()),
              "f: the compressed data is cut short; fetch the file again");
    std::string damaged = packed;
    damaged[packed.size() / 2] ^= 0x55;
    EXPECT_EQ(message(damaged, 10 * text.size()),
              "f: the compressed data is damaged; fetch the file again");
    EXPECT_EQ(message(packed + "rest", text.size()),
              "f: the compressed data is damaged; fetch the file again");
    EXPECT_THAT(message(packed, 10), testing::HasSubstr("f: decompresses to more than 10 bytes"));
  }
}

}  // namespace
}  // namespace cairn
