// SPDX-License-Identifier: BSD-3-Clause
// Whether the information of constraints says how wrong they are: against the truth of a simulated
// drive, over 20 seeds.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "frontends/laser/laser_frontend.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/support/offline_frontend_host.hpp"

namespace cairn {
namespace {

struct Constraint {
  bool loop = false;
  double nees = 0.0;  // e^T Omega e, 3 numbers: 3 on average where it is honest
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Se2 T_plan_to;
};

Constraint judge(const NewFactor& factor, const std::map<std::uint64_t, Se2>& truth) {
  const std::vector<double>& n = factor.numbers;
  Constraint constraint;
  constraint.loop = factor.kind == FactorKind::kLoop;
  constraint.information << n[3], n[4], n[5], n[4], n[6], n[7], n[5], n[7], n[8];
  constraint.T_plan_to = truth.at(factor.nodes[1].index);
  const Se2 T_from_to = truth.at(factor.nodes[0].index).inverse() * constraint.T_plan_to;
  const Eigen::Vector3d e = (Se2(n[0], n[1], n[2]).inverse() * T_from_to).to_vector();
  constraint.nees = e.dot(constraint.information * e);
  return constraint;
}

void add_constraints_of(std::uint64_t seed, std::vector<Constraint>& constraints) {
  const SimulatedDrive drive = simulate_drive({.seed = seed});
  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  const auto done = host.run(frontend, drive.scans);
  ASSERT_TRUE(done) << done.error().to_string();
  std::map<std::int64_t, std::size_t> scan_of;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) scan_of[drive.scans[i].stamp_ns] = i;
  std::map<std::uint64_t, Se2> truth;
  for (const Transaction& transaction : host.taken)
    for (const NewVariable& variable : transaction.variables)
      truth[variable.node.index] = drive.truth[scan_of.at(variable.stamp_ns)];
  for (const Transaction& transaction : host.taken)
    for (const NewFactor& factor : transaction.factors) constraints.push_back(judge(factor, truth));
}

std::vector<Constraint> constraints_of_20_drives() {
  std::vector<Constraint> constraints;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) add_constraints_of(seed, constraints);
  return constraints;
}

// The mean over N constraints is chi2 with 3 N degrees of freedom over N: 95 % of it within 1.96
// sqrt(6 / N) of 3.
void expect_in_band(const std::vector<Constraint>& constraints, bool loops, double at_least) {
  double sum = 0.0, count = 0.0, worst = 0.0;
  for (const Constraint& constraint : constraints) {
    if (constraint.loop != loops) continue;
    sum += constraint.nees;
    worst = std::max(worst, constraint.nees);
    ++count;
  }
  ASSERT_GT(count, at_least);
  EXPECT_NEAR(sum / count, 3.0, 1.96 * std::sqrt(6.0 / count)) << (loops ? "loops" : "tracker");
  testing::Test::RecordProperty(loops ? "worst_loop" : "worst_step", std::to_string(worst));
  if (loops) {
    EXPECT_LT(worst, 50.0) << "a false one";
  }
}

// The middle third of the northern corridor shows two parallel walls and nothing else. Matches say
// nothing along it (LaserTracker.SaysInWhichDirectionNothingHoldsIt); there odometry holds
// constraints, to 5 mm.
void expect_more_along_a_corridor_than_across(const std::vector<Constraint>& constraints) {
  std::vector<double> ratios;
  for (const Constraint& constraint : constraints) {
    const Eigen::Vector2d& p = constraint.T_plan_to.translation();
    if (constraint.loop || p.y() < 20.0 || p.x() < 12.5 || p.x() > 21.5) continue;
    const Eigen::Matrix2d covariance = constraint.information.inverse().topLeftCorner<2, 2>();
    const Eigen::Matrix2d R = constraint.T_plan_to.rotation().matrix();
    const Eigen::Matrix2d in_plan = R * covariance * R.transpose();
    ratios.push_back(std::sqrt(in_plan(0, 0) / in_plan(1, 1)));
  }
  ASSERT_GT(ratios.size(), 400u);
  std::sort(ratios.begin(), ratios.end());
  EXPECT_GT(ratios[ratios.size() / 2], 4.0) << ratios.front() << " .. " << ratios.back();
}

// One test, since ctest runs each in a process of its own and the drives are what takes long.
TEST(Covariances, SayHowWrongConstraintsAre) {
  const std::vector<Constraint> constraints = constraints_of_20_drives();
  expect_in_band(constraints, false, 8000.0);
  expect_in_band(constraints, true, 1000.0);
  expect_more_along_a_corridor_than_across(constraints);
}

}  // namespace
}  // namespace cairn
