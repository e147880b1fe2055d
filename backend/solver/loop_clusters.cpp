// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_clusters.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/solver/loop_groups.hpp"

namespace cairn {
namespace {

constexpr double kLooseShare = 0.25;  // of the limit, where the map gives way
constexpr double kLeastFirm = 1e-3;   // what is less is rounding
// Front-ends' mistakes come in short runs. Long runs of true loops bend, and no shift describes it.
constexpr std::size_t kShortRun = 4;
constexpr double kBend = 4.0;  // of chi2, for each loop more
constexpr std::size_t kMostLoops = 256;
constexpr std::size_t kMostWork = 500'000;  // loops times variables

template <class Pose>
class ClusterTest {
 public:
  ClusterTest(const LoopCycles<Pose>& cycles, const Graph& solved, const LoopFit<Pose>& fit,
              double noise_scale)
      : cycles_(cycles), graph_(solved), fit_(fit), noise_scale_(noise_scale) {}

  std::vector<std::size_t> run(const std::vector<bool>& in, const Marginals& marginals,
                               double scale) {
    find_clusters(in);
    if (loops_.empty()) return {};
    linearize(marginals);
    std::vector<std::size_t> shifted;
    double first = 0.0;
    while (const auto worst = worst_cluster(scale)) {
      const auto [cluster, excess] = *worst;
      if (excess < first / 4.0) break;
      first = std::max(first, excess);
      for (const Eigen::Index row : clusters_[cluster])
        shifted.push_back(loops_[static_cast<std::size_t>(row)]);
      leave_out(cluster);
    }
    return shifted;
  }

 private:
  static constexpr int d = LoopFit<Pose>::kDimension;
  using Matrix = typename LoopFit<Pose>::Matrix;
  using Vector = typename LoopFit<Pose>::Vector;
  using Rows = std::vector<Eigen::Index>;

  void find_clusters(const std::vector<bool>& in) {
    std::vector<std::size_t> between;
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in[i] && cycles_.leads_elsewhere(cycles_.loops()[i])) between.push_back(i);
    DisjointSets sets(between.size());
    for (std::size_t x = 0; x < between.size(); ++x) {
      const auto& first = cycles_.loops()[between[x]];
      for (std::size_t y = x + 1; y < between.size(); ++y) {
        const auto& second = cycles_.loops()[between[y]];
        if (!cycles_.nearby(first, second)) break;
        if (cycles_.distance(first, second) <= kReach &&
            cycles_.chi2(first, second) <= largest_chi2(d) * noise_scale_)
          sets.join(x, y);
      }
    }
    std::vector<std::vector<std::size_t>> found(between.size());
    for (std::size_t x = 0; x < between.size(); ++x) found[sets.root(x)].push_back(between[x]);
    std::erase_if(found, [](const auto& cluster) { return cluster.empty(); });
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& x, const auto& y) { return x.size() < y.size(); });
    const std::size_t most = std::min(kMostLoops, kMostWork / graph_.variables().size());
    for (const std::vector<std::size_t>& cluster : found) {
      if (loops_.size() + cluster.size() > most) return;
      Rows rows;
      for (const std::size_t loop : cluster) {
        rows.push_back(static_cast<Eigen::Index>(loops_.size()));
        loops_.push_back(loop);
      }
      clusters_.push_back(std::move(rows));
    }
  }

  // Errors, their covariance in the solution, and what a shift of each cluster does to them.
  void linearize(const Marginals& marginals) {
    const auto count = static_cast<Eigen::Index>(loops_.size());
    std::vector<std::pair<VariableSlot, VariableSlot>> ends;
    r_.resize(count * d);
    A_.resize(count * d, d);
    std::vector<Matrix> J;
    for (const std::size_t loop : loops_) {
      const auto whitened = fit_.whitened(cycles_.loops()[loop].factor);
      r_.segment(static_cast<Eigen::Index>(J.size()) * d, d) = whitened.error;
      J.push_back(whitened.J);
      ends.emplace_back(whitened.a, whitened.b);
    }
    S_ = marginals.relative_covariance(ends);
    for (Eigen::Index row = 0; row < count; ++row) {
      const Matrix& own = J[static_cast<std::size_t>(row)];
      S_.middleRows(row * d, d) = (own * S_.middleRows(row * d, d)).eval();
      S_.middleCols(row * d, d) = (S_.middleCols(row * d, d) * own.transpose()).eval();
    }
    for (const Rows& cluster : clusters_) {
      const Pose& T_map_first = second_end(cluster.front());
      for (const Eigen::Index row : cluster)
        A_.middleRows(row * d, d) = by_second_end(row, J[static_cast<std::size_t>(row)]) *
                                    (second_end(row).inverse() * T_map_first).adjoint();
    }
  }

  [[nodiscard]] const typename LoopCycles<Pose>::Loop& loop(Eigen::Index row) const {
    return cycles_.loops()[loops_[static_cast<std::size_t>(row)]];
  }
  [[nodiscard]] const Pose& pose(std::uint32_t index) const {
    if constexpr (std::is_same_v<Pose, Se2>)
      return graph_.values().pose2[index];
    else
      return graph_.values().pose3[index];
  }
  // On the later of the two chains; the factor may have it first.
  [[nodiscard]] const Pose& second_end(Eigen::Index row) const { return pose(loop(row).b); }
  [[nodiscard]] Matrix by_second_end(Eigen::Index row, const Matrix& by_T_a_b) const {
    if (!loop(row).turned) return by_T_a_b;
    const Pose T_b_a = pose(loop(row).b).inverse() * pose(loop(row).a);
    return -by_T_a_b * T_b_a.inverse().adjoint();
  }

  struct Shifted {
    std::size_t cluster;
    double excess;  // chi2 over its limit
  };
  [[nodiscard]] std::optional<Shifted> worst_cluster(double scale) const {
    std::optional<Shifted> worst;
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      if (clusters_[c].empty()) continue;
      const double excess = excess_of(clusters_[c]) / scale;
      if (excess > (worst ? worst->excess : 1.0)) worst = {c, excess};
    }
    return worst;
  }

  [[nodiscard]] double excess_of(const Rows& cluster) const {
    const std::vector<Eigen::Index> rows = scalar_rows(cluster);
    const Eigen::MatrixXd A = A_(rows, Eigen::all);
    const Matrix stated = A.transpose() * A;
    const Eigen::LLT<Matrix> root(stated);
    Matrix firm = A.transpose() * S_(rows, rows) * A;
    root.matrixL().solveInPlace(firm);
    root.matrixL().transpose().template solveInPlace<Eigen::OnTheRight>(firm);
    // Of what the cluster states, the shares that are not its own in the solution: ascending.
    const Eigen::SelfAdjointEigenSolver<Matrix> own(Matrix::Identity() -
                                                    0.5 * (firm + firm.transpose()));
    const Vector shift =
        own.eigenvectors().transpose() * root.matrixL().solve(Vector(A.transpose() * r_(rows)));
    const Vector share = own.eigenvalues().cwiseMax(kLeastFirm);
    const double chi2 = shift.cwiseAbs2().cwiseQuotient(share).sum();
    const double held = std::clamp(share[0], 0.0, 1.0);
    const auto more = static_cast<double>(cluster.size() - std::min(cluster.size(), kShortRun));
    return chi2 / (largest_chi2(d) * (kLooseShare + (1.0 - kLooseShare) * held) + kBend * more);
  }

  // The others' errors and covariance without it.
  void leave_out(std::size_t cluster) {
    const std::vector<Eigen::Index> rows = scalar_rows(std::exchange(clusters_[cluster], {}));
    const auto count = static_cast<Eigen::Index>(rows.size());
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(count, count) - S_(rows, rows);
    const Eigen::LDLT<Eigen::MatrixXd> solver(left);
    const Eigen::MatrixXd cross = S_(Eigen::all, rows);
    r_ += cross * solver.solve(Eigen::VectorXd(r_(rows)));
    S_ += cross * solver.solve(cross.transpose());
  }

  [[nodiscard]] static std::vector<Eigen::Index> scalar_rows(const Rows& cluster) {
    std::vector<Eigen::Index> rows;
    for (const Eigen::Index row : cluster)
      for (int k = 0; k < d; ++k) rows.push_back(row * d + k);
    return rows;
  }

  const LoopCycles<Pose>& cycles_;
  const Graph& graph_;
  const LoopFit<Pose>& fit_;
  double noise_scale_;
  std::vector<std::size_t> loops_;  // that are looked at
  std::vector<Rows> clusters_;      // of places in loops_; empty where they were left out
  Eigen::VectorXd r_;
  Eigen::MatrixXd S_, A_;
};

}  // namespace

template <class Pose>
std::vector<std::size_t> find_shifted_clusters(const LoopCycles<Pose>& cycles, const Graph& solved,
                                               const LoopFit<Pose>& fit,
                                               const std::vector<bool>& in,
                                               const Marginals& marginals, double noise_scale,
                                               double scale) {
  return ClusterTest<Pose>(cycles, solved, fit, noise_scale).run(in, marginals, scale);
}

template std::vector<std::size_t> find_shifted_clusters(const LoopCycles<Se2>&, const Graph&,
                                                        const LoopFit<Se2>&,
                                                        const std::vector<bool>&, const Marginals&,
                                                        double, double);
template std::vector<std::size_t> find_shifted_clusters(const LoopCycles<Se3>&, const Graph&,
                                                        const LoopFit<Se3>&,
                                                        const std::vector<bool>&, const Marginals&,
                                                        double, double);

}  // namespace cairn
