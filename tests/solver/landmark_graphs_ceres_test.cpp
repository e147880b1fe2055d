// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

Graph read(const std::string& path) {
  Result<GraphDocument> document = read_graph(path);
  EXPECT_TRUE(document) << document.error().to_string();
  return std::move(document.value().graph);
}

void perturb(Values& values, double sigma, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  for (Se2& T : values.pose2) T = T.retract({normal(random), normal(random), normal(random)});
  for (Eigen::Vector2d& p : values.point2) p += Eigen::Vector2d(normal(random), normal(random));
}

class LandmarkGraphTest : public ::testing::TestWithParam<std::string> {};

// No optimum of these graphs is published. An independent solver that starts all around ours must
// not find a better one.
TEST_P(LandmarkGraphTest, EndsWhereTheIndependentBackendEndsFromAllAround) {
  CAIRN_REQUIRE_DATASET(path, GetParam());
  Graph graph = read(path);
  const SolveSummary ours = optimize(graph, {.init = InitMethod::kAuto});
  EXPECT_TRUE(ours.usable()) << to_string(ours.stop_reason);
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Graph nearby = graph;
    perturb(nearby.values(), 1e-3, seed);
    const SolveSummary theirs =
        optimize(nearby, {.linear = LinearBackend::kCeres, .max_iterations = 500});
    EXPECT_LT(std::abs(theirs.final_chi2 - ours.final_chi2), 1e-6 * ours.final_chi2)
        << "seed " << seed << ": " << theirs.final_chi2 << " against " << ours.final_chi2;
  }
}

INSTANTIATE_TEST_SUITE_P(PublicGraphs, LandmarkGraphTest,
                         ::testing::Values("graphs/landmarks/victoriaPark.txt",
                                           "graphs/landmarks/dlr"),
                         [](const auto& test) {
                           return std::filesystem::path(test.param).stem().string();
                         });

}  // namespace
}  // namespace cairn
