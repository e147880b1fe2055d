// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cairn/factors/between.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/optimize.hpp"
#include "datasets/false_loops.hpp"
#include "datasets/simulate.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

using testing::IsEmpty;

Graph simulated(World world, std::size_t poses, std::uint64_t seed) {
  Result<SimulatedGraph> made = simulate({.world = world, .poses = poses, .seed = seed});
  EXPECT_TRUE(made);
  return std::move(made->graph);
}

std::set<std::size_t> left_out(const GatedSolution& solution) {
  std::set<std::size_t> places;
  for (const LeftOutLoop& loop : solution.left_out) places.insert(loop.factor);
  return places;
}

template <class F>
void find_all_and_only_false_loops(Graph graph, std::size_t count, std::size_t in_groups,
                                   std::uint64_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Graph clean = graph;
  const SolveOptions options{.init = InitMethod::kAuto};
  const double chi2 = optimize(clean, options).final_chi2;
  const std::set<std::size_t> false_loops =
      add_false_loops<F>(graph, clean, {.count = count, .in_groups = in_groups, .seed = seed});
  const GatedSolution solution = solve_gated(graph, options);
  ASSERT_TRUE(solution.summary.usable());
  ASSERT_EQ(false_loops.size(), count);
  EXPECT_EQ(left_out(solution), false_loops);
  EXPECT_NEAR(solution.summary.final_chi2, chi2, 1e-6 * chi2);
  for (const LeftOutLoop& loop : solution.left_out) EXPECT_GT(loop.value, loop.threshold);
}

std::uint64_t drawn_seed() {
  const char* given = std::getenv("CAIRN_SEED");
  const std::uint64_t seed = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::printf("CAIRN_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return seed;
}

TEST(LoopGate, HasNothingToSayOfAnEmptyGraph) {
  Graph graph;
  EXPECT_THAT(solve_gated(graph, {}).left_out, IsEmpty());
}

TEST(LoopGate, FindsFalseLoopsInThePlane) {
  for (const std::uint64_t seed : {1, 2, 3})
    find_all_and_only_false_loops<BetweenSe2>(simulated(World::kCity, 1000, seed), 30, 12, seed);
}

TEST(LoopGate, FindsFalseLoopsInSpace) {
  find_all_and_only_false_loops<BetweenSe3>(simulated(World::kSphere, 600, 1), 20, 8, 1);
}

TEST(LoopGate, FindsFalseLoopsOfPublicGraphs) {
  CAIRN_REQUIRE_DATASET(manhattan, "graphs/pose2/manhattan.g2o");
  CAIRN_REQUIRE_DATASET(sphere, "graphs/pose3/sphere2500.g2o");
  const std::uint64_t seed = drawn_seed();
  find_all_and_only_false_loops<BetweenSe2>(read_graph(manhattan)->graph, 100, 0, seed);
  find_all_and_only_false_loops<BetweenSe3>(read_graph(sphere)->graph, 100, 0, seed);
}

// Four robots, few loops between them: false ones hold each other, and the map gives way to them.
TEST(LoopGate, FindsFalseLoopsBetweenRobots) {
  CAIRN_REQUIRE_DATASET(folder, "graphs/multirobot/argos_clean_4robots");
  std::vector<std::string> paths;
  for (const char* robot : {"0", "1", "2", "3"}) paths.push_back(folder + "/" + robot + ".g2o");
  const Graph clean = read_graphs(paths)->graph;
  const SolveOptions options{.init = InitMethod::kAuto};
  Graph solved = clean;
  EXPECT_THAT(solve_gated(solved, options).left_out, IsEmpty());
  const std::uint64_t seed = drawn_seed();
  std::size_t drawn = 0, found = 0, lost = 0;
  for (std::uint64_t draw = 0; draw < 12; ++draw) {
    Graph graph = clean;
    const std::size_t count = std::vector<std::size_t>{5, 20, 50}[draw % 3];
    const std::set<std::size_t> false_loops = add_false_loops<BetweenSe3>(
        graph, solved,
        {.count = count, .in_groups = count / 3, .between_robots = true, .seed = seed + draw});
    const GatedSolution solution = solve_gated(graph, options);
    ASSERT_TRUE(solution.summary.usable()) << "draw " << draw;
    for (const LeftOutLoop& loop : solution.left_out) EXPECT_GT(loop.value, loop.threshold);
    drawn += false_loops.size();
    for (const std::size_t place : left_out(solution))
      ++(false_loops.contains(place) ? found : lost);
  }
  EXPECT_EQ(drawn, 300u);
  EXPECT_GE(found, 285u);
  EXPECT_LE(lost, 19u) << "2 % of 12 times 83";
}

class CleanGraphTest : public testing::TestWithParam<const char*> {};

TEST_P(CleanGraphTest, KeepsAllLoopsAndFindsTheOptimum) {
  CAIRN_REQUIRE_DATASET(path, GetParam());
  Graph graph = read_graph(path)->graph, plain = graph;
  const SolveOptions options{.init = InitMethod::kAuto};
  const GatedSolution solution = solve_gated(graph, options);
  EXPECT_THAT(solution.left_out, IsEmpty());
  const double chi2 = optimize(plain, options).final_chi2;
  EXPECT_NEAR(solution.summary.final_chi2, chi2, 1e-6 * chi2);
}

INSTANTIATE_TEST_SUITE_P(PublicGraphs, CleanGraphTest,
                         testing::Values("graphs/pose2/manhattan.g2o", "graphs/pose2/city10000.g2o",
                                         "graphs/pose2/CSAIL.g2o", "graphs/pose2/kitti_00.g2o",
                                         "graphs/pose2/M3500a.g2o", "graphs/pose3/sphere2500.g2o",
                                         "graphs/pose3/parking-garage.g2o"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

TEST(LoopGate, TakesACopyForNoWitness) {
  Graph graph = simulated(World::kCity, 400, 1), clean = graph;
  optimize(clean, {.init = InitMethod::kAuto});
  std::set<std::size_t> false_loops =
      add_false_loops<BetweenSe2>(graph, clean, {.count = 1, .seed = 7});
  const FactorRef loop = graph.factors()[*false_loops.begin()];
  const std::vector<VariableSlot> ends = graph.slots_of(loop);
  false_loops.insert(graph.factor_count());
  ASSERT_TRUE(graph.add_factor(graph.find_batch<BetweenSe2>()->factor(loop.index),
                               {graph.variables()[ends[0]].id, graph.variables()[ends[1]].id},
                               FactorKind::kLoop));
  const GatedSolution solution = solve_gated(graph, {.init = InitMethod::kAuto});
  EXPECT_EQ(left_out(solution), false_loops);
}

TEST(LoopGate, KeepsALonelyLoopThatOdometryAgreesWith) {
  Graph graph = simulated(World::kCity, 300, 1);
  std::vector<bool> kept(graph.factor_count(), true);
  bool found = false;  // all loops but the first
  for (std::size_t place = 0; place < kept.size(); ++place) {
    const FactorRef factor = graph.factors()[place];
    if (graph.batches()[factor.batch]->kinds()[factor.index] == FactorKind::kLoop)
      kept[place] = !std::exchange(found, true);
  }
  Graph lonely = graph.with_factors(kept);
  const GatedSolution solution = solve_gated(lonely, {.init = InitMethod::kAuto});
  EXPECT_EQ(solution.loops, 1u);
  EXPECT_THAT(solution.left_out, IsEmpty());
}

TEST(LoopGate, HasNothingToSayWithoutLoops) {
  Graph graph;
  const SolveOptions options{.init = InitMethod::kAuto};
  ASSERT_TRUE(graph.add_pose2(VariableId{0}, {}));
  ASSERT_TRUE(graph.add_pose2(VariableId{1}, {}));
  BetweenSe2 step;
  step.information.setIdentity();
  ASSERT_TRUE(graph.add_factor(step, {VariableId{0}, VariableId{1}}, FactorKind::kOdometry));
  const GatedSolution solution = solve_gated(graph, options);
  EXPECT_TRUE(solution.summary.usable());
  EXPECT_EQ(solution.loops, 0u);
}

// Adds the poses and factors of `other` behind those of `graph`, with ids from `first` on.
void append(Graph& graph, const Graph& other, std::uint64_t first) {
  for (const Variable& variable : other.variables()) {
    const VariableId id{variable.id.value + first};
    if (variable.type == VariableType::kPose2)
      ASSERT_TRUE(graph.add_pose2(id, other.values().pose2[variable.index]));
    else
      ASSERT_TRUE(graph.add_pose3(id, other.values().pose3[variable.index]));
  }
  const auto add = [&]<class F>(const TypedBatch<F>* batch) {
    for (std::uint32_t i = 0; batch != nullptr && i < batch->size(); ++i) {
      const auto indices = batch->variable_indices().subspan(2 * i, 2);
      std::array<VariableId, 2> ids;
      for (std::size_t k = 0; k < 2; ++k)
        ids[k] = {other.variables()[other.slot_of(batch->signature()[k], indices[k])].id.value +
                  first};
      ASSERT_TRUE(graph.add_factor(batch->factor(i), ids, batch->kinds()[i]));
    }
  };
  add(other.find_batch<BetweenSe2>());
  add(other.find_batch<BetweenSe3>());
}

TEST(LoopGate, GatesThePlaneAndSpaceApart) {
  Graph city = simulated(World::kCity, 600, 4), sphere = simulated(World::kSphere, 400, 4);
  Graph solved_city = city, solved_sphere = sphere;
  optimize(solved_city, {.init = InitMethod::kAuto});
  optimize(solved_sphere, {.init = InitMethod::kAuto});
  const auto in_city = add_false_loops<BetweenSe2>(city, solved_city, {.count = 5, .seed = 4});
  const auto in_sphere =
      add_false_loops<BetweenSe3>(sphere, solved_sphere, {.count = 5, .seed = 4});
  std::set<std::size_t> expected = in_city;
  for (const std::size_t place : in_sphere) expected.insert(city.factor_count() + place);
  append(city, sphere, 100'000);
  EXPECT_EQ(left_out(solve_gated(city, {.init = InitMethod::kAuto})), expected);
}

// Two robots in one city: the second half of the drive is another robot's, whose odometry begins
// anew.
Graph two_robots(std::size_t poses, std::uint64_t seed, std::size_t loops_between) {
  const Graph drive = simulated(World::kCity, poses, seed);
  std::vector<bool> kept(drive.factor_count(), true);
  std::size_t between = 0;
  std::set<std::uint64_t> used;
  for (std::size_t f = 0; f < drive.factor_count(); ++f) {
    const std::vector<VariableSlot> slots = drive.slots_of(drive.factors()[f]);
    const bool first = drive.variables()[slots[0]].id.value < poses / 2;
    const bool second = drive.variables()[slots[1]].id.value < poses / 2;
    if (first == second) continue;
    const FactorRef factor = drive.factors()[f];
    const bool loop = drive.batches()[factor.batch]->kinds()[factor.index] == FactorKind::kLoop;
    const bool fresh = !used.contains(slots[0]) && !used.contains(slots[1]);
    kept[f] = loop && fresh && between < loops_between;
    if (!kept[f]) continue;
    used.insert({slots[0], slots[1]});
    ++between;
  }
  EXPECT_EQ(between, loops_between);
  return drive.with_factors(kept);
}

TEST(LoopGate, TiesTwoRobotsByThreeLoopsThatAgreeAndNoFewer) {
  Graph three = two_robots(1000, 6, 3);
  GateOptions gate;
  for (const Variable& variable : three.variables()) gate.frames.push_back(variable.id.value < 500);
  const GatedSolution tied = solve_gated(three, {.init = InitMethod::kAuto}, gate);
  EXPECT_THAT(tied.left_out, IsEmpty());
  EXPECT_EQ(tied.summary.components, 1);
  Graph two = two_robots(1000, 6, 2);
  const GatedSolution apart = solve_gated(two, {.init = InitMethod::kAuto}, gate);
  ASSERT_EQ(apart.left_out.size(), 2u);
  for (const LeftOutLoop& loop : apart.left_out) {
    EXPECT_EQ(loop.test, GateTest::kTooFew);
    EXPECT_EQ(loop.value, 2.0);
    EXPECT_EQ(loop.threshold, 3.0);
  }
  gate.loops_that_join = 2;
  Graph again = two_robots(1000, 6, 2);
  EXPECT_THAT(solve_gated(again, {.init = InitMethod::kAuto}, gate).left_out, IsEmpty());
}

TEST(LoopGate, TiesPiecesOfOneRobotsOdometryByAnyLoop) {
  Graph one = two_robots(1000, 6, 1);
  const GatedSolution tied = solve_gated(one, {.init = InitMethod::kAuto});
  EXPECT_THAT(tied.left_out, IsEmpty());
  EXPECT_EQ(tied.summary.components, 1);
}

TEST(LoopGate, EndsWhenItIsToldTo) {
  Graph graph = simulated(World::kCity, 600, 4);
  int asked = 0;
  const GatedSolution solution =
      solve_gated(graph, {.init = InitMethod::kAuto}, {.keep_going = [&] { return ++asked < 3; }});
  EXPECT_EQ(solution.summary.stop_reason, StopReason::kInterrupted);
  EXPECT_FALSE(solution.summary.usable());
  EXPECT_EQ(asked, 3);
}

// The referee: a graph of the cycle alone, fitted by the solver.
TEST(LoopCycles, GiveTheChi2OfTheirBestFit) {
  const Graph graph = simulated(World::kCity, 400, 3);
  const LoopCycles<Se2> cycles(graph);
  const auto id_of = [&](std::uint32_t pose) {
    return graph.variables()[graph.slot_of(VariableType::kPose2, pose)].id.value;
  };
  int compared = 0;
  for (std::size_t k = 0; k + 1 < cycles.loops().size(); ++k) {
    const auto &x = cycles.loops()[k], &y = cycles.loops()[k + 1];
    if (cycles.distance(x, y) > 10) continue;
    Graph cycle;
    const auto add = [&](std::uint64_t id) { (void)cycle.add_pose2(VariableId{id}, {}); };
    const auto stretch = [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(std::min(id_of(a), id_of(b)), std::max(id_of(a), id_of(b)));
    };
    const auto [a1, a2] = stretch(x.a, y.a);
    const auto [b1, b2] = stretch(x.b, y.b);
    for (std::uint64_t id = a1; id <= a2; ++id) add(id);
    for (std::uint64_t id = b1; id <= b2; ++id) add(id);
    for (std::size_t place = 0; place < graph.factor_count(); ++place) {
      const FactorRef factor = graph.factors()[place];
      const auto& batch = *graph.find_batch<BetweenSe2>();
      const auto slots = graph.slots_of(factor);
      const VariableId from = graph.variables()[slots[0]].id, to = graph.variables()[slots[1]].id;
      const FactorKind kind = batch.kinds()[factor.index];
      if (kind == FactorKind::kOdometry ? (!cycle.find(from) || !cycle.find(to))
                                        : (place != x.factor && place != y.factor))
        continue;
      ASSERT_TRUE(cycle.add_factor(batch.factor(factor.index), {from, to}, kind));
    }
    const double best = optimize(cycle, {.init = InitMethod::kOdometry}).final_chi2;
    EXPECT_NEAR(cycles.chi2(x, y), best, 0.02 * best + 1e-6) << k;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace cairn
