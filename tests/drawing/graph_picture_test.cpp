// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/graph_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cairn/factors/between.hpp"
#include "tests/support/picture_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace cairn;
using test::is_well_formed_svg;
using test::png_size;
using test::read_file;

// A spiral walk with a loop closure from every tenth pose to one a lap earlier.
Graph spiral(int poses) {
  Graph graph;
  const auto pose = [](int i) {
    const double angle = 0.05 * i;
    return Se2(angle * std::cos(angle), angle * std::sin(angle), angle);
  };
  const auto join = [&](int a, int b, FactorKind kind) {
    const Se2 T_a_b = pose(a).inverse() * pose(b) * Se2(0.01, 0.0, 0.0);
    EXPECT_TRUE(graph.add_factor(
        BetweenSe2{T_a_b, Eigen::Matrix3d::Identity()},
        {VariableId{static_cast<std::uint64_t>(a)}, VariableId{static_cast<std::uint64_t>(b)}},
        kind));
  };
  for (int i = 0; i < poses; ++i) {
    EXPECT_TRUE(graph.add_pose2(VariableId{static_cast<std::uint64_t>(i)}, pose(i)));
    if (i > 0) join(i - 1, i, FactorKind::kOdometry);
    if (i > 126 && i % 10 == 0) join(i - 126, i, FactorKind::kLoop);
  }
  return graph;
}

Result<void> draw(const Graph& graph, const std::string& path,
                  const PictureOptions& options = {.title = "spiral"}) {
  const std::vector<GraphView> views{{.graph = &graph, .caption = "before"},
                                     {.graph = &graph, .caption = "after"}};
  return draw_graphs(views, path, options);
}

TEST(GraphPicture, IsAPngOfTheSizeAskedFor) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(draw(spiral(500), folder.file("a.png"),
                   {.title = "spiral", .width_px = 640, .height_px = 480}));
  EXPECT_EQ(png_size(read_file(folder.file("a.png"))), std::pair(640, 480));
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(GraphPicture, IsAWellFormedSvgOfBoundedSize) {
  const test::TemporaryFolder folder;
  for (const int poses : {1, 2, 500, 200'000}) {
    ASSERT_TRUE(draw(spiral(poses), folder.file("a.svg")));
    const std::string svg = read_file(folder.file("a.svg"));
    EXPECT_TRUE(is_well_formed_svg(svg)) << poses << " poses";
    EXPECT_LT(svg.size(), 8'000'000u) << poses << " poses";
  }
}

TEST(GraphPicture, ShowsSpatialGraphsWithLandmarksAndTruth) {
  const test::TemporaryFolder folder;
  Graph graph;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(10 * std::cos(0.3 * i), 10 * std::sin(0.3 * i), 0.2 * i);
    ASSERT_TRUE(graph.add_pose3(VariableId{static_cast<std::uint64_t>(i)}, Se3(So3(), p)));
  }
  ASSERT_TRUE(graph.add_point3(VariableId{900}, {1.0, 2.0, 3.0}));
  const std::vector<GraphView> views{{.graph = &graph, .caption = "helix"}};
  ASSERT_TRUE(draw_graphs(views, folder.file("a.png"), {}, {.graph = &graph}));
  EXPECT_TRUE(png_size(read_file(folder.file("a.png"))));
}

TEST(GraphPicture, RefusesAnEmptyGraph) {
  const test::TemporaryFolder folder;
  const auto drawn = draw(Graph(), folder.file("a.png"));
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(drawn.error().message, "the graph is empty: it has no poses and no landmarks to draw");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(GraphPicture, NamesTheFirstVariableThatIsNotFinite) {
  const test::TemporaryFolder folder;
  Graph graph = spiral(20);
  graph.values().pose2[7] = Se2(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  const auto drawn = draw(graph, folder.file("a.svg"));
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().message,
            "1 of 20 variables have no finite position (the first is variable 7); run `cairn "
            "check` on the graph");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(GraphPicture, RefusesOtherEndingsAndSizes) {
  EXPECT_EQ(draw(spiral(3), "picture.jpg").error().code, ErrorCode::kUsage);
  EXPECT_EQ(draw(spiral(3), "a.png", {.width_px = 100'000}).error().code, ErrorCode::kUsage);
}

TEST(GraphPicture, TakesTitlesThatAreNotUtf8) {
  const test::TemporaryFolder folder;
  const std::string title = "caf\xE9 \x01 " + std::string(500, 'x');
  ASSERT_TRUE(draw(spiral(30), folder.file("a.svg"), {.title = title}));
  EXPECT_TRUE(is_well_formed_svg(read_file(folder.file("a.svg"))));
}

TEST(GraphPicture, SurvivesHugeAndTinyCoordinates) {
  const test::TemporaryFolder folder;
  for (const double scale : {1e-12, 1e140}) {
    Graph graph = spiral(300);
    for (Se2& T_map_body : graph.values().pose2) {
      T_map_body = Se2(scale * T_map_body.x(), scale * T_map_body.y(), T_map_body.theta());
    }
    EXPECT_TRUE(draw(graph, folder.file("a.svg"))) << scale;
  }
}

}  // namespace
