// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/front_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>

namespace cairn {
namespace {

constexpr double kUntouched = 7e77;

struct Front {
  Front(int rows, int columns, std::uint32_t seed) : m(rows), n(columns) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(m, m + 3, [&] { return normal(random); });
    A = root * root.transpose();
    A.diagonal().array() += 0.1;
    const Eigen::MatrixXd A11 = A.topLeftCorner(n, n);
    L11 = A11.llt().matrixL();
    L21 = L11.triangularView<Eigen::Lower>()
              .solve(A.bottomLeftCorner(m - n, n).transpose())
              .transpose();
    b = Eigen::VectorXd::NullaryExpr(m, [&] { return normal(random); });
    panel = padded(A.leftCols(n));
    inverse.resize(n);
  }

  // Column-major numbers with something behind their end that must not matter or change.
  static std::vector<double> padded(const Eigen::MatrixXd& matrix) {
    std::vector<double> numbers(matrix.data(), matrix.data() + matrix.size());
    numbers.resize(numbers.size() + kFrontSlack, kUntouched);
    return numbers;
  }

  int m, n;
  Eigen::MatrixXd A, L11, L21;
  Eigen::VectorXd b;
  std::vector<double> panel, inverse;
};

void expect_slack_untouched(const std::vector<double>& numbers) {
  for (int i = 0; i < kFrontSlack; ++i) EXPECT_EQ(numbers[numbers.size() - 1 - i], kUntouched);
}

// Every size near the widths of the tiles, and some large ones.
std::vector<std::pair<int, int>> sizes() {
  std::vector<std::pair<int, int>> all{{70, 70}, {131, 47}, {200, 3}, {150, 149}};
  for (int m = 1; m <= 40; ++m)
    for (int n = 1; n <= std::min(m, 20); ++n) all.emplace_back(m, n);
  return all;
}

class FrontKernelsTest : public ::testing::TestWithParam<const FrontKernels*> {};

TEST_P(FrontKernelsTest, EqualDenseCholeskyAtEverySize) {
  for (const auto& [m, n] : sizes()) {
    SCOPED_TRACE(::testing::Message() << m << " rows, " << n << " eliminated");
    Front front(m, n, static_cast<std::uint32_t>(100 * m + n));
    ASSERT_TRUE(GetParam()->factorize_panel(m, n, front.panel.data(), front.inverse.data()));
    const Eigen::Map<const Eigen::MatrixXd> panel(front.panel.data(), m, n);
    const double tolerance = 1e-10 * front.A.norm();
    const Eigen::MatrixXd L11 = panel.topRows(n).triangularView<Eigen::Lower>();
    EXPECT_LT((L11 - front.L11).norm(), tolerance);
    EXPECT_LT((panel.bottomRows(m - n) - front.L21).norm(), tolerance);
    expect_slack_untouched(front.panel);

    const int below = m - n;
    std::vector<double> C = Front::padded(Eigen::MatrixXd::Zero(below, below));
    GetParam()->negative_square(m, n, front.panel.data(), C.data());
    const Eigen::MatrixXd difference = Eigen::Map<const Eigen::MatrixXd>(C.data(), below, below) +
                                       front.L21 * front.L21.transpose();
    EXPECT_LT(Eigen::MatrixXd(difference.triangularView<Eigen::Lower>()).norm(), tolerance);
    expect_slack_untouched(C);
  }
}

TEST_P(FrontKernelsTest, AddAChildsRowsAndColumnsWhereTheyBelong) {
  // 30 rows of a child in a front of 50, of which the first 20 are eliminated.
  const std::vector<FrontRun> runs{{0, 2, 3}, {3, 9, 6}, {9, 18, 9}, {18, 30, 1}, {19, 33, 11}};
  const int child = 30, m = 50, n = 20;
  const Front front(child, 1, 5);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(m, m);
  std::vector<int> place;
  for (const FrontRun& run : runs)
    for (int i = 0; i < run.length; ++i) place.push_back(run.to + i);
  for (int c = 0; c < child; ++c)
    for (int r = c; r < child; ++r) expected(place[r], place[c]) = front.A(r, c);

  const std::vector<double> from = Front::padded(front.A);
  std::vector<double> panel = Front::padded(Eigen::MatrixXd::Zero(m, n));
  std::vector<double> leftover = Front::padded(Eigen::MatrixXd::Zero(m - n, m - n));
  const FrontRun* end = runs.data() + runs.size();
  GetParam()->add_lower(runs.data(), end, 0, n, from.data(), child, panel.data(), m);
  GetParam()->add_lower(runs.data(), end, n, m, from.data(), child, leftover.data(), m - n);
  EXPECT_EQ(Eigen::Map<Eigen::MatrixXd>(panel.data(), m, n), expected.leftCols(n));
  EXPECT_EQ(Eigen::Map<Eigen::MatrixXd>(leftover.data(), m - n, m - n),
            expected.bottomRightCorner(m - n, m - n));
  expect_slack_untouched(panel);
  expect_slack_untouched(leftover);
}

TEST_P(FrontKernelsTest, SolveWithTheFactorAtEverySize) {
  for (const auto& [m, n] : sizes()) {
    SCOPED_TRACE(::testing::Message() << m << " rows, " << n << " eliminated");
    Front front(m, n, static_cast<std::uint32_t>(100 * m + n));
    ASSERT_TRUE(GetParam()->factorize_panel(m, n, front.panel.data(), front.inverse.data()));
    const double tolerance = 1e-8 * front.b.norm();

    std::vector<double> x = Front::padded(front.b);
    GetParam()->solve_lower(m, n, front.panel.data(), front.inverse.data(), x.data());
    Eigen::VectorXd expected = front.b;
    expected.head(n) = front.L11.triangularView<Eigen::Lower>().solve(front.b.head(n));
    expected.tail(m - n) -= front.L21 * expected.head(n);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), m) - expected).norm(), tolerance);
    expect_slack_untouched(x);

    x = Front::padded(front.b);
    GetParam()->solve_upper(m, n, front.panel.data(), front.inverse.data(), x.data());
    expected = front.b;
    const Eigen::MatrixXd U11 = front.L11.transpose();
    const Eigen::VectorXd rest = front.b.head(n) - front.L21.transpose() * front.b.tail(m - n);
    expected.head(n) = U11.triangularView<Eigen::Upper>().solve(rest);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), m) - expected).norm(), tolerance);
    expect_slack_untouched(x);
  }
}

TEST_P(FrontKernelsTest, RefuseWhatIsNotPositiveDefinite) {
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    for (int n = 1; n <= 15; ++n) {
      for (int place = 0; place < n; ++place) {
        Front front(20, n, 3);
        front.panel[static_cast<std::size_t>(place * 21)] = wrong;
        EXPECT_FALSE(GetParam()->factorize_panel(20, n, front.panel.data(), front.inverse.data()))
            << wrong << " at " << place << " of " << n;
      }
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<const FrontKernels*>& info) {
  constexpr const char* kNames[] = {"fastest", "portable", "avx2", "avx512"};
  return kNames[static_cast<int>(info.param->kernel)];
}

INSTANTIATE_TEST_SUITE_P(Runnable, FrontKernelsTest, ::testing::ValuesIn(runnable_front_kernels()),
                         name_of);

}  // namespace
}  // namespace cairn
