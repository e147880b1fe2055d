// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/relations.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

std::string message_of(const std::string& text) {
  const auto relations = read_relations_text(text, "f");
  return relations ? "accepted" : relations.error().to_string();
}

// A scan of two beams.
std::string scan(const std::string& stamp) {
  return "ROBOTLASER1 0 -1.57 3.14 0.01 50 0.1 0 2 1.5 1.6 0 0 0 0 0 0 0 0 0 0 0 0 " + stamp +
         " x 0.08\n";
}

TEST(Relations, AreReadToTheNanosecondWithTheirLines) {
  const auto read = read_relations_text(
      "# truth\n\n976052905.167303 976052911.885496 -0.5 0.25 1 0 0 -1.5\r\n1 2 0 0 0 0.1 0.2 "
      "0.3\n",
      "f");
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->relations.size(), 2u);
  const Relation& first = read->relations[0];
  EXPECT_EQ(first.from_ns, 976052905167303000u);
  EXPECT_EQ(first.to_ns, 976052911885496000u);
  EXPECT_EQ(first.line, 3u);
  EXPECT_EQ(first.T_from_to.translation(), Eigen::Vector3d(-0.5, 0.25, 1.0));
  EXPECT_NEAR(first.T_from_to.rotation().log().z(), -1.5, 1e-12);
  // Rz(yaw) Ry(pitch) Rx(roll)
  const Eigen::Matrix3d R = read->relations[1].T_from_to.rotation().matrix();
  EXPECT_NEAR(std::atan2(R(1, 0), R(0, 0)), 0.3, 1e-12);
  EXPECT_NEAR(std::asin(-R(2, 0)), 0.2, 1e-12);
}

TEST(Relations, OfALogAreItsLoopsWithTheStampsOfItsScans) {
  const auto read = read_relations_text(
      "VERTEX2 10 0 0 0\n" + scan("5.000001") + "VERTEX2 11 1 0 0\n" + scan("6") +
          "VERTEX2 12 2 0 0\n" + scan("7.5") +
          "#LOOP EDGES\nEDGE2 10 11 1 0 0 1 0 1 1 0 0\nEDGE2 12 11 1 0 0 1 0 1 1 0 0\n"
          "EDGE2 10 12 2 0.5 -0.25 1 0 1 1 0 0\n",
      "f");
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->relations.size(), 1u);
  EXPECT_EQ(read->relations[0].from_ns, 5000001000u);
  EXPECT_EQ(read->relations[0].to_ns, 7500000000u);
  EXPECT_EQ(read->relations[0].line, 10u);
  EXPECT_EQ(read->relations[0].T_from_to.translation(), Eigen::Vector3d(2.0, 0.5, 0.0));
  EXPECT_NEAR(read->relations[0].T_from_to.rotation().log().z(), -0.25, 1e-12);
}

struct Case {
  std::string text, message;
};
class MalformedRelations : public testing::TestWithParam<Case> {};
TEST_P(MalformedRelations, GetOneExactMessage) {
  EXPECT_EQ(message_of(GetParam().text), GetParam().message);
}

const std::string kVertex = "VERTEX2 0 0 0 0\n";
INSTANTIATE_TEST_SUITE_P(
    Texts, MalformedRelations,
    testing::Values(
        Case{"", "f:1:1: holds no relations"}, Case{"# nothing\n", "f:1:1: holds no relations"},
        Case{"1 2 0 0 0 0 0\n",
             "f:1:1: a relation has 8 numbers (t1 t2 x y z roll pitch yaw), found 7"},
        Case{"1 2 0 0 0 0 0 0 0\n",
             "f:1:1: a relation has 8 numbers (t1 t2 x y z roll pitch yaw), found 9"},
        Case{"1 2 0 0 0 0 0 0\nx 2 0 0 0 0 0 0\n", "f:2:1: 'x' is not a number"},
        Case{"1 -2 0 0 0 0 0 0\n",
             "f:1:3: '-2' is not a time stamp: seconds from 0 to 9e9 are expected"},
        Case{"1 2 0 nan 0 0 0 0\n", "f:1:7: 'nan' is not a finite number"},
        Case{"1 2 0 0 0 0 0 1,5\n", "f:1:15: '1,5' has a decimal comma; write 1.5"},
        Case{"1 2 0 0 0 0 0 0\n" + kVertex,
             "f:2:1: a relation has 8 numbers (t1 t2 x y z roll pitch yaw), found 5"},
        Case{kVertex + "ODOM 1 2\n",
             "f:2:1: 'ODOM' does not belong into a log with its graph; VERTEX2, ROBOTLASER1 and "
             "EDGE2 do"},
        Case{"VERTEX2 0 0 0\n", "f:1:1: VERTEX2 expects 4 numbers, found 3"},
        Case{scan("1"), "f:1:1: a scan without a VERTEX2 before it; of which pose is it?"},
        Case{kVertex + "ROBOTLASER1 1 2\n", "f:2:1: the scan is cut short"},
        Case{kVertex + "ROBOTLASER1 late x 0\n", "f:2:13: 'late' is not a number"},
        Case{kVertex + scan("1") + kVertex + scan("2"), "f:4:1: vertex 0 is defined twice"},
        Case{kVertex + scan("1") + "EDGE2 0 1 0 0 0\n", "f:3:1: EDGE2 expects 11 numbers, found 5"},
        Case{kVertex + scan("1") + "EDGE2 0 1 0 0 0 1 0 1 1 0 0\n",
             "f:3:9: vertex 1 has no stamp; a VERTEX2 line and the ROBOTLASER1 line behind it are "
             "expected"},
        Case{kVertex + scan("1"),
             "f:1:1: holds no loops: every EDGE2 joins scans that follow each other"}));

TEST(Relations, OfPublicDataAreAllThere) {
  CAIRN_REQUIRE_DATASET(intel, "laser/intel.relations");
  const auto truth = read_relations(intel);
  ASSERT_TRUE(truth) << truth.error().to_string();
  EXPECT_EQ(truth->relations.size(), 2984u);
  CAIRN_REQUIRE_DATASET(csail, "laser/flirt_mit-csail.log");
  const auto loops = read_relations(csail);
  ASSERT_TRUE(loops) << loops.error().to_string();
  ASSERT_EQ(loops->relations.size(), 139u);
  EXPECT_EQ(loops->relations[0].line, 3155u);
}

}  // namespace
}  // namespace cairn
