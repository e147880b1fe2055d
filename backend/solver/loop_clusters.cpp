// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_clusters.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>
#include <type_traits>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/solver/loop_groups.hpp"

namespace cairn {
namespace {

// Of the limit, between chains where the map gives way. True loops are far out more often in the
// plane.
constexpr double loose_share(int dimension) { return dimension <= 3 ? 0.5 : 0.15; }
constexpr double kLeastFirm = 1e-3;  // what is less is rounding
// Front-ends' mistakes come in short runs. Long runs of true loops bend, and no shift describes it.
constexpr std::size_t kShortRun = 4;
constexpr double kBend = 4.0;  // of chi2, for each loop more
constexpr std::size_t kMostSuspects = 256;
constexpr std::size_t kMostWork = 500'000;  // suspects times variables

template <class Pose>
class ClusterTest {
 public:
  ClusterTest(const LoopCycles<Pose>& cycles, const Graph& solved, const LoopFit<Pose>& fit,
              double scale)
      : cycles_(cycles), graph_(solved), fit_(fit), scale_(scale) {}

  std::vector<ShiftedLoop> run(const std::vector<std::pair<std::size_t, std::size_t>>& agreeing,
                               const std::vector<bool>& in, const Marginals& marginals) {
    find_clusters(agreeing, in);
    keep_suspects(marginals);
    if (clusters_.empty()) return {};
    correlate(marginals);
    std::vector<ShiftedLoop> shifted;
    double first = 0.0;
    while (const auto worst = worst_cluster()) {
      if (worst->judged.excess < first / 4.0) break;
      first = std::max(first, worst->judged.excess);
      for (const std::size_t loop : worst->cluster->loops)
        shifted.push_back({loop, worst->judged.chi2, worst->judged.excess});
      leave_out(*worst->cluster);
    }
    return shifted;
  }

 private:
  static constexpr int d = LoopFit<Pose>::kDimension;
  using Matrix = typename LoopFit<Pose>::Matrix;
  using Vector = typename LoopFit<Pose>::Vector;
  using Whitened = typename LoopFit<Pose>::Whitened;
  using Loop = typename LoopCycles<Pose>::Loop;

  struct Judged {
    double chi2, excess;  // over its limit
  };
  struct Cluster {
    std::vector<std::size_t> loops;
    double excess = 0.0;             // at most, of chi2 over its limit
    std::vector<Eigen::Index> rows;  // of r_, S_, A_; none where it was left out
  };

  void find_clusters(const std::vector<std::pair<std::size_t, std::size_t>>& agreeing,
                     const std::vector<bool>& in) {
    DisjointSets sets(in.size());
    for (const auto& [x, y] : agreeing)
      if (in[x] && in[y]) sets.join(x, y);
    std::vector<std::size_t> of_root(in.size(), in.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
      if (!in[i]) continue;
      std::size_t& cluster = of_root[sets.root(i)];
      if (cluster == in.size()) {
        cluster = clusters_.size();
        clusters_.emplace_back();
      }
      clusters_[cluster].loops.push_back(i);
    }
    std::erase_if(clusters_, [this](const Cluster& cluster) {
      const std::size_t size = cluster.loops.size();
      return !is_between(cluster) && (size == 1 || size > 2 * kShortRun);
    });
  }
  [[nodiscard]] bool is_between(const Cluster& cluster) const {
    return cycles_.leads_elsewhere(cycles_.loops()[cluster.loops.front()]);
  }

  // By a bound first: as if the errors of a cluster were fully correlated.
  void keep_suspects(const Marginals& marginals) {
    if (clusters_.empty()) return;  // as of a graph without variables
    acquit([&](Cluster& cluster) { return excess_of(cluster, marginals, true); });
    std::stable_sort(clusters_.begin(), clusters_.end(),
                     [](const Cluster& x, const Cluster& y) { return x.excess > y.excess; });
    const std::size_t most = std::min(kMostSuspects, kMostWork / graph_.variables().size());
    clusters_.resize(std::min(clusters_.size(), most));
    acquit([&](Cluster& cluster) { return excess_of(cluster, marginals, false); });
  }
  template <class Excess>
  void acquit(const Excess& excess) {
    for (Cluster& cluster : clusters_) cluster.excess = excess(cluster);
    std::erase_if(clusters_, [](const Cluster& cluster) { return cluster.excess <= 1.0; });
  }
  [[nodiscard]] double excess_of(const Cluster& cluster, const Marginals& marginals,
                                 bool at_most) const {
    Matrix stated = Matrix::Zero(), own = Matrix::Zero();
    Vector pull = Vector::Zero();
    std::vector<std::pair<VariableSlot, VariableSlot>> ends;
    std::vector<Eigen::MatrixXd> weights;
    for (const std::size_t loop : cluster.loops) {
      const Whitened whitened = fit_.whitened(factor(loop));
      const Matrix A = by_shift(cluster, loop, whitened.J);
      stated += A.transpose() * A;
      pull += A.transpose() * whitened.error;
      ends.emplace_back(whitened.a, whitened.b);
      weights.emplace_back(whitened.J.transpose() * A);
      if (at_most)
        own += weights.back().transpose() * marginals.relative_covariance(whitened.a, whitened.b) *
               weights.back();
    }
    own = at_most ? Matrix(static_cast<double>(ends.size()) * own)
                  : Matrix(marginals.covariance_of_sum(ends, weights));
    return judge(cluster, stated, own, pull).excess;
  }

  // Errors, their covariance in the solution, and what a shift of each cluster does to them.
  void correlate(const Marginals& marginals) {
    std::vector<Whitened> all;
    std::vector<std::pair<VariableSlot, VariableSlot>> ends;
    for (const Cluster& cluster : clusters_) {
      for (const std::size_t loop : cluster.loops) {
        all.push_back(fit_.whitened(factor(loop)));
        ends.emplace_back(all.back().a, all.back().b);
      }
    }
    S_ = marginals.relative_covariance(ends);
    r_.resize(S_.rows());
    A_.resize(S_.rows(), d);
    Eigen::Index row = 0;
    auto whitened = all.begin();
    for (Cluster& cluster : clusters_) {
      for (const std::size_t loop : cluster.loops) {
        r_.template segment<d>(row) = whitened->error;
        A_.template middleRows<d>(row) = by_shift(cluster, loop, whitened->J);
        S_.template middleRows<d>(row) = (whitened->J * S_.template middleRows<d>(row)).eval();
        S_.template middleCols<d>(row) =
            (S_.template middleCols<d>(row) * whitened->J.transpose()).eval();
        ++whitened;
        for (int k = 0; k < d; ++k) cluster.rows.push_back(row++);
      }
    }
  }

  [[nodiscard]] std::size_t factor(std::size_t loop) const { return cycles_.loops()[loop].factor; }
  [[nodiscard]] const Pose& pose(std::uint32_t index) const {
    if constexpr (std::is_same_v<Pose, Se2>)
      return graph_.values().pose2[index];
    else
      return graph_.values().pose3[index];
  }
  // Of a loop's error, by the shift of its cluster at b of the first one.
  [[nodiscard]] Matrix by_shift(const Cluster& cluster, std::size_t loop,
                                const Matrix& by_T_a_b) const {
    const Loop &own = cycles_.loops()[loop], &first = cycles_.loops()[cluster.loops.front()];
    const Matrix by_b =
        own.turned ? Matrix(-by_T_a_b * (pose(own.a).inverse() * pose(own.b)).adjoint()) : by_T_a_b;
    return by_b * (pose(own.b).inverse() * pose(first.b)).adjoint();
  }

  struct Shifted {
    Cluster* cluster;
    Judged judged;
  };
  std::optional<Shifted> worst_cluster() {
    std::optional<Shifted> worst;
    for (Cluster& cluster : clusters_) {
      if (cluster.rows.empty()) continue;
      const Eigen::Matrix<double, Eigen::Dynamic, d> A = A_(cluster.rows, Eigen::all);
      const Matrix own = A.transpose() * S_(cluster.rows, cluster.rows) * A;
      const Vector pull = A.transpose() * r_(cluster.rows);
      const Judged judged = judge(cluster, A.transpose() * A, own, pull);
      if (judged.excess > (worst ? worst->judged.excess : 1.0)) worst = {&cluster, judged};
    }
    return worst;
  }

  // Of the shift; by A^T A, A^T S A, A^T r.
  [[nodiscard]] Judged judge(const Cluster& cluster, const Matrix& stated, Matrix own,
                             const Vector& pull) const {
    const Eigen::LLT<Matrix> root(stated);
    root.matrixL().solveInPlace(own);
    root.matrixU().template solveInPlace<Eigen::OnTheRight>(own);
    const Eigen::SelfAdjointEigenSolver<Matrix> shares(0.5 * (own + own.transpose()));
    const Vector shift = shares.eigenvectors().transpose() * root.matrixL().solve(pull);
    const Vector firm = (1.0 - shares.eigenvalues().array()).max(kLeastFirm);
    const double chi2 = shift.cwiseAbs2().cwiseQuotient(firm).sum();
    const double loose = is_between(cluster) ? 1.0 - std::min(firm.minCoeff(), 1.0) : 0.0;
    const auto more =
        static_cast<double>(cluster.loops.size() - std::min(cluster.loops.size(), kShortRun));
    const double limit = largest_chi2(d) * (1.0 - loose * (1.0 - loose_share(d))) + kBend * more;
    return {chi2, chi2 / (limit * scale_)};
  }

  // The others' errors and covariance without it.
  void leave_out(Cluster& cluster) {
    const std::vector<Eigen::Index> rows = std::exchange(cluster.rows, {});
    const auto count = static_cast<Eigen::Index>(rows.size());
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(count, count) - S_(rows, rows);
    const Eigen::LDLT<Eigen::MatrixXd> solver(left);
    const Eigen::MatrixXd cross = S_(Eigen::all, rows);
    r_ += cross * solver.solve(Eigen::VectorXd(r_(rows)));
    S_ += cross * solver.solve(cross.transpose());
  }

  const LoopCycles<Pose>& cycles_;
  const Graph& graph_;
  const LoopFit<Pose>& fit_;
  double scale_;
  std::vector<Cluster> clusters_;
  Eigen::VectorXd r_;
  Eigen::MatrixXd S_, A_;
};

}  // namespace

template <class Pose>
std::vector<ShiftedLoop> find_shifted_clusters(
    const LoopCycles<Pose>& cycles,
    const std::vector<std::pair<std::size_t, std::size_t>>& agreeing, const Graph& solved,
    const LoopFit<Pose>& fit, const std::vector<bool>& in, const Marginals& marginals,
    double scale) {
  return ClusterTest<Pose>(cycles, solved, fit, scale).run(agreeing, in, marginals);
}

template std::vector<ShiftedLoop> find_shifted_clusters(
    const LoopCycles<Se2>&, const std::vector<std::pair<std::size_t, std::size_t>>&, const Graph&,
    const LoopFit<Se2>&, const std::vector<bool>&, const Marginals&, double);
template std::vector<ShiftedLoop> find_shifted_clusters(
    const LoopCycles<Se3>&, const std::vector<std::pair<std::size_t, std::size_t>>&, const Graph&,
    const LoopFit<Se3>&, const std::vector<bool>&, const Marginals&, double);

}  // namespace cairn
