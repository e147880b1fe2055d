// SPDX-License-Identifier: BSD-3-Clause
// How long do the covariances of all poses take, against Ceres' covariance estimation? Both start
// from the optimum; both times include linearization and structure.
#include <ceres/covariance.h>

#include <cmath>
#include <cstdio>

#include "benchmarks/support/ceres_rival.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/linear/single_thread_blas.hpp"
#include "cairn/solver/marginals.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn::bench {
namespace {

double cairn_seconds(const Graph& graph, std::vector<Eigen::MatrixXd>& covariances) {
  const Stopwatch watch;
  const Result<Marginals> marginals = Marginals::compute(graph);
  if (!marginals) return std::nan("");
  covariances.clear();
  for (VariableSlot slot = 0; slot < graph.variables().size(); ++slot) {
    covariances.push_back(marginals->covariance(slot));
  }
  return watch.seconds();
}

// Sparse QR is Ceres' only sparse method here; Eigen's takes minutes where SuiteSparse's takes a
// second.
double ceres_seconds(CeresPoseGraph& rival, std::vector<Eigen::MatrixXd>& covariances) {
  const Stopwatch watch;
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = 1;
  std::vector<std::pair<const double*, const double*>> blocks;
  for (std::size_t i = 0; i < rival.poses(); ++i) blocks.emplace_back(rival.pose(i), rival.pose(i));
  ceres::Covariance covariance(options);
  if (!covariance.Compute(blocks, &rival.problem())) return std::nan("");
  covariances.clear();
  const int dimension = rival.tangent_dimension();
  for (const auto& [block, same] : blocks) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> of_one(dimension,
                                                                                  dimension);
    covariance.GetCovarianceBlockInTangentSpace(block, same, of_one.data());
    covariances.emplace_back(of_one);
  }
  return watch.seconds();
}

// Ceres' planar poses have x and y in the map frame, ours in the frame of the pose: compare what
// does not depend on the frame.
double worst_difference(const std::vector<Eigen::MatrixXd>& ours,
                        const std::vector<Eigen::MatrixXd>& theirs) {
  double worst = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < ours.size() && i < theirs.size(); ++i) {
    worst = std::max(worst, std::abs(ours[i].trace() - theirs[i].trace()));
    scale = std::max(scale, theirs[i].trace());
  }
  return worst / scale;
}

void compare(const BenchmarkGraph& which, int rounds, const Table& table) {
  std::optional<Graph> graph = load(which);
  if (!graph) return;
  *graph = common_start(which, *graph);
  optimize(*graph);
  CeresPoseGraph rival(*graph);
  rival.build();
  std::vector<Eigen::MatrixXd> ours, theirs;
  const std::function<double()> contenders[] = {
      [&] { return cairn_seconds(*graph, ours); },
      [&] { return ceres_seconds(rival, theirs); },
  };
  const std::vector<double> seconds = interleaved_medians(rounds, contenders);
  table.row({std::string(which.name), time_text(seconds[0]), time_text(seconds[1]),
             ratio_text(seconds[1] / seconds[0]), number_text(worst_difference(ours, theirs), 12)});
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  Arguments arguments = parse_arguments(argc, argv);
  const cairn::SingleThreadBlas single_thread;
  if (arguments.names.empty()) arguments.names = {"manhattan", "intel"};
  std::puts("## All pose marginals against ceres::Covariance\n");
  const Table table({"graph", "Cairn", "Ceres, SuiteSparseQR", "Ceres / Cairn",
                     "worst difference of traces, relative"});
  for (const BenchmarkGraph& graph : benchmark_graphs()) {
    if (arguments.wants(graph.name)) compare(graph, arguments.rounds, table);
  }
}
