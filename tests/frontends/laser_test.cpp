// SPDX-License-Identifier: BSD-3-Clause
// Matching, tracking and loop closing, on a simulated drive with truth and on a real log.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cairn/evaluation/relations.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/replay/settle.hpp"
#include "datasets/random.hpp"
#include "frontends/carmen/carmen_log.hpp"
#include "frontends/laser/laser_frontend.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

// A host without a daemon: what comes is in a map at once, which is settled now and then.
class OfflineHost final : public FrontendContext {
 public:
  [[nodiscard]] FrontendRoles roles() const override { return {}; }
  [[nodiscard]] const std::string& robot() const override { return robot_; }
  [[nodiscard]] std::uint64_t epoch() const override { return 1; }
  [[nodiscard]] std::uint64_t keyframes_before() const override { return before; }
  Result<void> submit_keyframe(Transaction transaction) override {
    ++keyframes;
    return take(std::move(transaction));
  }
  Result<void> submit_loops(Transaction transaction) override {
    loops += transaction.factors.size();
    since_solve_ += transaction.factors.size();
    return take(std::move(transaction));
  }
  Result<ContentHash> send_payload(const std::string&, const std::string& bytes) override {
    return content_hash(bytes);
  }
  void localize(const LocalizedFrame& frame) override { frames.push_back(frame); }

  void run(Frontend& frontend, const std::vector<LaserScan>& scans) {
    ASSERT_TRUE(frontend.start(*this));
    for (const LaserScan& scan : scans) {
      const auto done = frontend.process(scan);
      ASSERT_TRUE(done) << done.error().to_string();
      if (since_solve_ >= 10) tell(frontend);
    }
    tell(frontend);
    ASSERT_TRUE(frontend.stop());
  }
  // Where the laser was at each frame.
  [[nodiscard]] std::vector<Se2> trajectory() const {
    std::map<std::uint64_t, Se2> poses;
    for (NodeIndex i = 0; i < head_.graph().nodes.size(); ++i) {
      const Estimate& e = head_.graph().estimates[i];
      poses[head_.graph().nodes[i].id.index] = Se2(e[0], e[1], e[2]);
    }
    std::vector<Se2> all;
    for (const LocalizedFrame& frame : frames)
      all.push_back(poses.at(frame.keyframe.index) * frame.T_keyframe_body);
    return all;
  }

  std::uint64_t before = 0;
  std::size_t keyframes = 0, loops = 0;
  std::vector<LocalizedFrame> frames;

 private:
  Result<void> take(Transaction transaction) {
    transaction.key = {"laser", 1, ++number_};
    if (const auto refusal = head_.check(transaction))
      return Error{ErrorCode::kNotUsable, refusal->reason};
    head_.apply(transaction, {1, 0, number_});
    return {};
  }
  void tell(Frontend& frontend) {
    since_solve_ = 0;
    const SettledEstimate settled = settle(head_.graph());
    ASSERT_TRUE(settled.summary.usable());
    head_.apply_estimates(changed_estimates(head_.graph(), settled), head_.graph().graph_revision,
                          {1, 0, ++number_});
    MapSnapshot snapshot;
    PoseChunk chunk;
    chunk.frame = {robot_, 1};
    for (NodeIndex i = 0; i < head_.graph().nodes.size(); ++i)
      chunk.poses.push_back({head_.graph().nodes[i].id.index, 0, head_.graph().estimates[i]});
    snapshot.changed.push_back(std::move(chunk));
    frontend.on_snapshot(snapshot);
  }

  std::string robot_ = "robot";
  MapHead head_;
  std::uint64_t number_ = 0;
  std::size_t since_solve_ = 0;
};

const SimulatedDrive& drive() {
  static const SimulatedDrive one = simulate_drive();
  return one;
}

Se2 draw_offset(Random& random, double m, double rad) {
  return {random.uniform(-m, m), random.uniform(-m, m), random.uniform(-rad, rad)};
}

// Where walls show every direction: along a corridor (scan 900) nothing says how far to go.
TEST(PointToLine, FindsAKnownOffset) {
  Random random(7);
  for (const std::size_t at : {20u, 300u, 1500u}) {
    const std::vector<SurfacePoint> points = surface_points(drive().scans[at]);
    const PointMap map(points, 0.5);
    for (int trial = 0; trial < 10; ++trial) {
      const PointToLineMatch match =
          match_point_to_line(map, points, draw_offset(random, 0.1, 0.05));
      EXPECT_TRUE(match.converged);
      EXPECT_LT(match.T_map_scan.translation().norm(), 1e-3) << at;
      EXPECT_LT(std::abs(match.T_map_scan.theta()), 1e-3) << at;
    }
  }
}

TEST(PointMap, FindsTheNearestAlikeAsASlowSearchDoes) {
  Random random(3);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 500; ++i) {
    const double angle = random.uniform(-3.1, 3.1);
    points.push_back(
        {{random.uniform(-5, 5), random.uniform(-5, 5)}, {std::cos(angle), std::sin(angle)}});
    if (i % 10 == 0) points.back().normal.setZero();
  }
  const PointMap map(points, 0.6);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d at(random.uniform(-6, 6), random.uniform(-6, 6));
    const double angle = random.uniform(-3.1, 3.1);
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    const double within = random.uniform(0.05, 0.6);
    const SurfacePoint* best = nullptr;
    for (const SurfacePoint& point : points) {
      if (point.normal.isZero() || point.normal.dot(normal) < 0.5) continue;
      const double distance = (point.position - at).norm();
      if (distance <= within && (best == nullptr || distance < (best->position - at).norm()))
        best = &point;
    }
    const SurfacePoint* const found = map.nearest(at, normal, within);
    ASSERT_EQ(found == nullptr, best == nullptr);
    if (best != nullptr) {
      EXPECT_EQ(found->position, best->position);
    }
  }
  EXPECT_EQ(PointMap({}, 0.5).nearest({0, 0}, {1, 0}, 0.5), nullptr);
}

// Branch and bound ends where trying every pose does.
TEST(Correlative, FindsTheBestPoseOfTheWindow) {
  Random random(11);
  const std::vector<SurfacePoint> points = surface_points(drive().scans[300]);
  const LikelihoodGrid grid(points, {});
  for (int trial = 0; trial < 5; ++trial) {
    const Se2 start = draw_offset(random, 0.8, 0.3);
    const auto found = match_correlative(grid, points, start, {1.0, 1.0, 0.4}, 0.3);
    ASSERT_TRUE(found);
    EXPECT_LT(found->T_map_scan.translation().norm(), 0.1);
    EXPECT_LT(std::abs(found->T_map_scan.theta()), 0.02);
    EXPECT_GT(found->score, 0.8);
  }
  EXPECT_FALSE(match_correlative(grid, points, Se2(), {1.0, 1.0, 0.4}, 0.3, 10))
      << "work is limited";
  EXPECT_FALSE(match_correlative(grid, {}, Se2(), {}, 0.1));
  const LikelihoodGrid nothing({}, {});
  EXPECT_FALSE(match_correlative(nothing, points, Se2(), {}, 0.1));
}

TEST(LaserFrontend, MapsASimulatedBuilding) {
  LaserFrontend frontend;
  OfflineHost host;
  host.run(frontend, drive().scans);
  ASSERT_EQ(host.frames.size(), drive().scans.size());
  EXPECT_GT(host.loops, 0u);
  const std::vector<Se2> found = host.trajectory();
  // The same origin for both: the first scan.
  const Se2 T = drive().truth.front() * found.front().inverse();
  double squares = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i)
    squares += ((T * found[i]).translation() - drive().truth[i].translation()).squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(found.size())), 0.15);

  // The same bits again; and what a run before has submitted is not sent again.
  LaserFrontend again;
  OfflineHost second;
  second.run(again, drive().scans);
  ASSERT_EQ(second.trajectory().size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(second.trajectory()[i].to_vector(), found[i].to_vector());
}

TEST(LaserFrontend, SurvivesScansThatSayNothing) {
  LaserFrontend frontend;
  OfflineHost host;
  LaserScan nothing = drive().scans[0];
  for (float& range : nothing.ranges_m) range = NAN;
  LaserScan far = nothing;
  for (float& range : far.ranges_m) range = 1e9F;
  LaserScan empty = nothing;
  empty.ranges_m.clear();
  LaserScan blind = nothing;
  blind.T_odom_laser.reset();
  ASSERT_TRUE(frontend.start(host));
  for (const LaserScan& scan : {nothing, drive().scans[0], far, drive().scans[1], empty, blind})
    EXPECT_TRUE(frontend.process(scan));
  for (const LocalizedFrame& frame : host.frames)
    EXPECT_TRUE(frame.T_keyframe_body.to_vector().allFinite());
}

// Raw odometry scores 7.370 m on these relations, the best published system 0.0229 m and 0.45 deg.
TEST(LaserFrontend, MapsIntelAsWellAsTheBest) {
  const auto log = test::dataset("laser/intel.clf.bz2");
  const auto truth = test::dataset("laser/intel.relations");
  if (!log || !truth) GTEST_SKIP() << "data set absent";
  const auto carmen = read_carmen_log(log->string());
  ASSERT_TRUE(carmen) << carmen.error().to_string();
  LaserFrontend frontend;
  OfflineHost host;
  host.run(frontend, carmen->scans);
  const std::vector<Se2> found = host.trajectory();
  Trajectory estimate;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector2d& p = found[i].translation();
    const double half = 0.5 * found[i].theta();
    estimate.poses.push_back({static_cast<std::uint64_t>(host.frames[i].stamp_ns),
                              Se3(So3(Eigen::Quaterniond(std::cos(half), 0.0, 0.0, std::sin(half))),
                                  {p.x(), p.y(), 0.0})});
  }
  const auto relations = read_relations(truth->string());
  ASSERT_TRUE(relations) << relations.error().to_string();
  const auto errors = relation_errors(*relations, estimate);
  ASSERT_TRUE(errors) << errors.error().to_string();
  EXPECT_EQ(errors->errors.translation_m.size(), 2984u);
  EXPECT_TRUE(errors->unmatched.empty());
  EXPECT_LT(compute_statistics(errors->errors.translation_m).mean, 0.0229);
  EXPECT_LT(compute_statistics(errors->errors.rotation_deg).mean, 0.45);
}

}  // namespace
}  // namespace cairn
