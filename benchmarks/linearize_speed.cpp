// SPDX-License-Identifier: BSD-3-Clause
// How long does one factor take to linearize, and how long to evaluate? Prints nanoseconds per
// factor on one core. A chain of poses with loop closures, factors and targets in memory order,
// best of many rounds.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <vector>

#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "tests/support/random.hpp"

namespace {

using cairn::EvaluationContext;
using cairn::FactorBatch;
using cairn::NormalEquationTargets;

constexpr std::size_t kFactors = 5000;
constexpr int kRounds = 400;

template <class Function>
double best_nanoseconds_per_factor(Function function) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    function();
    const std::chrono::duration<double, std::nano> elapsed =
        std::chrono::steady_clock::now() - start;
    best = std::min(best, elapsed.count() / kFactors);
  }
  return best;
}

// As the solver lays them out: diagonal blocks with gradients one after the other, off-diagonal
// blocks in columns.
struct Targets {
  std::vector<double> diagonal, blocks;
  std::vector<std::size_t> diagonal_offset;
  std::vector<NormalEquationTargets::OffDiagonal> off_diagonal;

  explicit Targets(const FactorBatch& batch) {
    const int a = cairn::tangent_dimension(batch.signature()[0]),
              b = cairn::tangent_dimension(batch.signature()[1]);
    std::size_t diagonal_size = 0, block_size = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      for (const int d : {a, b}) {
        diagonal_offset.push_back(diagonal_size);
        diagonal_size += static_cast<std::size_t>(d * d + d);
      }
      off_diagonal.push_back({block_size, 2 * a, false});
      block_size += static_cast<std::size_t>(2 * a * b);
    }
    diagonal.resize(diagonal_size);
    blocks.resize(block_size);
  }
};

void report(const FactorBatch& batch, const cairn::Values& values) {
  Targets targets(batch);
  const EvaluationContext context{values};
  double sum = 0.0;
  const double cost = best_nanoseconds_per_factor(
      [&] { sum += batch.evaluate_cost(0, batch.size(), context).chi2; });
  const double linearize = best_nanoseconds_per_factor([&] {
    sum += batch
               .linearize(0, batch.size(), context,
                          {targets.diagonal.data(), targets.diagonal_offset.data(),
                           targets.blocks.data(), targets.off_diagonal.data()})
               .chi2;
  });
  const std::string name(batch.type_name());
  std::printf("%-14s linearize %6.1f ns   cost %6.1f ns   (checksum %.6g)\n", name.c_str(),
              linearize, cost, sum);
}

template <class F, class MakeFactor>
void measure(MakeFactor make_factor) {
  cairn::test::Random random(1);
  cairn::Values values;
  const std::size_t kPoses = kFactors / 2;
  for (std::size_t i = 0; i < kPoses; ++i) {
    for (const auto type : {cairn::VariableType::kPose2, cairn::VariableType::kPose3,
                            cairn::VariableType::kPoint2, cairn::VariableType::kPoint3}) {
      cairn::test::append_random_variable(type, random, values);
    }
  }
  cairn::TypedBatch<F> batch;
  for (std::size_t i = 0; i < kFactors; ++i) {
    const auto a = static_cast<std::uint32_t>(i / 2);
    const auto b = static_cast<std::uint32_t>(i % 2 ? random.index(kPoses) : (a + 1) % kPoses);
    batch.add(make_factor(random), {a, b}, cairn::FactorKind::kOdometry);
  }
  report(batch, values);
}

}  // namespace

int main() {
  using cairn::test::Random;
  measure<cairn::BetweenSe2>([](Random& random) {
    return cairn::BetweenSe2{random.pose2(), random.information<3>()};
  });
  measure<cairn::BetweenSe3>([](Random& random) {
    return cairn::BetweenSe3{random.pose3(), random.information<6>()};
  });
  measure<cairn::LandmarkXy>([](Random& random) {
    return cairn::LandmarkXy{random.vector<2>(10.0), {}, random.information<2>()};
  });
  measure<cairn::LandmarkXyz>([](Random& random) {
    return cairn::LandmarkXyz{random.vector<3>(10.0), {}, random.information<3>()};
  });
}
