// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/linear_solver.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "tests/support/reference_solver.hpp"

namespace cairn {
namespace {

struct Backend {
  std::string name;
  std::function<std::unique_ptr<LinearSolver>()> make;
  double tolerance;  ///< relative error of the solution per condition number of about 1e3
  bool sees_pivots;  ///< refuses every indefinite matrix, not only indefinite diagonal blocks
};

void PrintTo(const Backend& backend, std::ostream* out) { *out << backend.name; }

class LinearSolverTest : public ::testing::TestWithParam<Backend> {};

TEST_P(LinearSolverTest, EqualsDenseCholeskyOnRandomBlockMatrices) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    test::RandomBlockSystem system(10 + 5 * static_cast<int>(seed), seed);
    const auto solver = GetParam().make();
    solver->analyze(system.pattern, system.elimination);
    ASSERT_TRUE(solver->factorize(system.values.data())) << "seed " << seed;
    const Eigen::VectorXd b = system.normal(system.pattern.scalar_size(), 1);
    const Eigen::MatrixXd A = test::to_dense(system.pattern, system.values);
    const Eigen::VectorXd expected = A.llt().solve(b);
    Eigen::VectorXd x(b.size());
    solver->solve(b.data(), x.data());
    EXPECT_LT((x - expected).norm(), GetParam().tolerance * expected.norm()) << "seed " << seed;
    Eigen::VectorXd in_place = b;  // b and x may be the same
    solver->solve(in_place.data(), in_place.data());
    EXPECT_EQ(in_place, x) << "seed " << seed;
  }
}

// What maps are mostly made of, and what they are made of at worst.
TEST_P(LinearSolverTest, EqualsDenseCholeskyOnShapesWithoutLoopsAndWithAllLoops) {
  using Pairs = std::vector<std::pair<int, int>>;
  constexpr int kBlocks = 40;
  Pairs chain, star, forest, complete;
  for (int i = 1; i < kBlocks; ++i) {
    chain.emplace_back(i - 1, i);
    star.emplace_back(0, i);
    if (i % 5 != 0) forest.emplace_back(i, i - (i % 5 + 1) / 2);  // pieces of five, some branched
    for (int j = 0; j < i; ++j) complete.emplace_back(i, j);
  }
  const std::pair<const char*, Pairs> shapes[] = {
      {"nothing coupled", {}}, {"chain", chain},       {"star", star},
      {"forest", forest},      {"complete", complete},
  };
  for (const auto& [shape, pairs] : shapes) {
    test::RandomBlockSystem system(kBlocks, pairs, 17);
    const auto solver = GetParam().make();
    solver->analyze(system.pattern, system.elimination);
    ASSERT_TRUE(solver->factorize(system.values.data())) << shape;
    const Eigen::VectorXd b = system.normal(system.pattern.scalar_size(), 1);
    Eigen::VectorXd x(b.size());
    solver->solve(b.data(), x.data());
    const Eigen::VectorXd expected = test::to_dense(system.pattern, system.values).llt().solve(b);
    EXPECT_LT((x - expected).norm(), GetParam().tolerance * expected.norm()) << shape;
  }
}

TEST_P(LinearSolverTest, TakesNewValuesForTheSamePattern) {
  test::RandomBlockSystem system(30, 7);
  const auto solver = GetParam().make();
  solver->analyze(system.pattern, system.elimination);
  const Eigen::VectorXd b = system.normal(system.pattern.scalar_size(), 1);
  Eigen::VectorXd first(b.size()), doubled(b.size());
  ASSERT_TRUE(solver->factorize(system.values.data()));
  solver->solve(b.data(), first.data());
  for (double& value : system.values) value *= 2.0;
  ASSERT_TRUE(solver->factorize(system.values.data()));
  solver->solve(b.data(), doubled.data());
  EXPECT_LT((first - 2.0 * doubled).norm(), 1e-12 * first.norm());
}

TEST_P(LinearSolverTest, RefusesANegativeDiagonalAndWorksAfterwards) {
  test::RandomBlockSystem system(30, 3);
  const auto solver = GetParam().make();
  solver->analyze(system.pattern, system.elimination);
  std::vector<double> broken = system.values;
  broken[system.pattern.value_begin[20]] = -1.0;
  EXPECT_FALSE(solver->factorize(broken.data()));
  ASSERT_TRUE(solver->factorize(system.values.data()));
  const Eigen::VectorXd b = system.normal(system.pattern.scalar_size(), 1);
  Eigen::VectorXd x(b.size());
  solver->solve(b.data(), x.data());
  const Eigen::VectorXd expected = test::to_dense(system.pattern, system.values).llt().solve(b);
  EXPECT_LT((x - expected).norm(), GetParam().tolerance * expected.norm());
}

// Without a factor only the diagonal blocks are looked at, and these are positive.
TEST_P(LinearSolverTest, RefusesAnIndefiniteMatrixWithPositiveDiagonalBlocksIfItSeesPivots) {
  test::RandomBlockSystem system(30, 5);
  const auto solver = GetParam().make();
  solver->analyze(system.pattern, system.elimination);
  std::vector<double> broken = system.values;
  for (int j = 0; j < system.pattern.size(); ++j) {  // make the couplings dominate
    for (int column = 0; column < system.size(j); ++column) {
      double* panel = broken.data() + system.pattern.value_begin[j] +
                      static_cast<std::size_t>(column * system.pattern.height[j]);
      for (int row = system.size(j); row < system.pattern.height[j]; ++row) panel[row] *= 10.0;
    }
  }
  EXPECT_EQ(solver->factorize(broken.data()), !GetParam().sees_pivots);
  ASSERT_TRUE(solver->factorize(system.values.data()));
}

TEST_P(LinearSolverTest, CountsTheNumbersOfItsFactor) {
  test::RandomBlockSystem system(30, 9);
  const auto solver = GetParam().make();
  solver->analyze(system.pattern, system.elimination);
  ASSERT_TRUE(solver->factorize(system.values.data()));
  const std::optional<std::int64_t> nonzeros = solver->factor_nonzeros();
  EXPECT_EQ(nonzeros.has_value(), GetParam().sees_pivots);
  if (!nonzeros) return;
  EXPECT_GE(*nonzeros, system.pattern.scalar_size());
  EXPECT_LE(*nonzeros, system.pattern.scalar_size() * system.pattern.scalar_size());
}

// PCG stops at 1e-8 of |b|, so its error is that times the condition number.
INSTANTIATE_TEST_SUITE_P(
    All, LinearSolverTest,
    ::testing::Values(Backend{"Cholmod", [] { return make_cholmod_solver(); }, 1e-10, true},
                      Backend{"Multifrontal", [] { return make_multifrontal_solver(); }, 1e-10,
                              true},
                      Backend{"Eigen", [] { return make_eigen_solver(); }, 1e-10, true},
                      Backend{"Pcg", [] { return make_pcg_solver(); }, 1e-5, false}),
    [](const auto& test) { return test.param.name; });

// L L^T rebuilt from the panels is A.
TEST(SupernodalFactor, IsAFactorWhoseProductIsTheMatrix) {
  const std::vector<std::pair<int, int>> few = test::RandomBlockSystem::map_with_loops(100, 11);
  std::vector<std::pair<int, int>> many = few;
  for (const std::uint32_t seed : {12, 13, 14}) {
    const auto more = test::RandomBlockSystem::map_with_loops(100, seed);
    many.insert(many.end(), more.begin(), more.end());
  }
  // CHOLMOD takes the one with few loops column by column, the other by supernodes.
  for (const auto& [own, loops] : {std::pair(true, few), std::pair(true, many),
                                   std::pair(false, few), std::pair(false, many)}) {
    test::RandomBlockSystem system(100, loops, 11);
    const auto solver = own ? make_multifrontal_solver() : make_cholmod_solver();
    solver->analyze(system.pattern, system.elimination);
    ASSERT_TRUE(solver->factorize(system.values.data()));
    const SupernodalFactor factor = *solver->factor();
    const int n = system.pattern.scalar_size();
    EXPECT_EQ(factor.supernodes() < n, own || loops == many);
    Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < factor.supernodes(); ++k) {
      for (int c = 0; c < factor.columns(k); ++c) {
        for (int r = c; r < factor.rows(k); ++r) {
          L(factor.s[factor.pi[k] + r], factor.super[k] + c) =
              factor.x[factor.px[k] + static_cast<std::size_t>(c * factor.rows(k) + r)];
        }
        EXPECT_EQ(factor.diagonal(k, c), L(factor.super[k] + c, factor.super[k] + c));
      }
    }
    const Eigen::MatrixXd A = test::to_dense(system.pattern, system.values);
    EXPECT_LT((L * L.transpose() - A).norm(), 1e-13 * A.norm());
  }
}

}  // namespace
}  // namespace cairn
