// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/information_checks.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "cairn/diagnostics/conventions.hpp"
#include "cairn/diagnostics/line_repairs.hpp"
#include "cairn/geometry/information.hpp"

namespace cairn {
namespace {

Eigen::MatrixXd upper_triangular(std::span<const double> numbers, int n) {
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(n, n);
  std::size_t next = 0;
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c) upper(r, c) = numbers[next++];
  }
  return upper;
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& omega) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(omega, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

// The readers' own test, in radians.
bool is_accepted(const Eigen::MatrixXd& omega, InformationLayout layout) {
  Eigen::MatrixXd in_radians = omega;
  if (layout == InformationLayout::kG2oSe3) {
    Eigen::VectorXd half = Eigen::VectorXd::Ones(6);
    half.tail<3>().setConstant(0.5);
    in_radians = half.asDiagonal() * omega * half.asDiagonal();
  }
  if (Eigen::LLT<Eigen::MatrixXd>(in_radians).info() == Eigen::Success) return true;
  const Eigen::VectorXd lambda = eigenvalues(in_radians);
  return lambda.minCoeff() >= -1e-9 * lambda.cwiseAbs().maxCoeff();
}

// Omega with its negative eigenvalues set to zero, where they are small next to the diagonal; empty
// where they are not. The diagonal is scaled to one first, so that metres and radians weigh alike.
Eigen::MatrixXd clamped(const Eigen::MatrixXd& omega) {
  constexpr double kSlight = 0.01;
  if (!(omega.diagonal().minCoeff() > 0.0)) return {};
  const Eigen::VectorXd scale = omega.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse.asDiagonal() * omega *
                                                             inverse.asDiagonal());
  if (!(eigen.eigenvalues().minCoeff() >= -kSlight)) return {};
  const Eigen::MatrixXd positive = eigen.eigenvectors() *
                                   eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                   eigen.eigenvectors().transpose();
  return scale.asDiagonal() * positive * scale.asDiagonal();
}

std::vector<double> layout_numbers(const Eigen::MatrixXd& omega, InformationLayout layout) {
  std::vector<double> numbers;
  for (int r = 0; r < omega.rows(); ++r) {
    for (int c = r; c < omega.cols(); ++c) numbers.push_back(omega(r, c));
  }
  if (layout != InformationLayout::kToro2) return numbers;
  std::array<double, 6> row_major{};
  std::copy(numbers.begin(), numbers.end(), row_major.begin());
  const auto toro = reorder_planar_information(row_major, PlanarOrder::kToro);
  return {toro.begin(), toro.end()};
}

void repair(const RawLine& line, const Eigen::MatrixXd& omega, Repairs& repairs) {
  if (!repairs.open(line.line)) return;
  const Eigen::MatrixXd repaired = clamped(omega);
  if (repaired.size() == 0) return;
  std::vector<Repairs::Replacement> parts;
  const auto first = static_cast<std::size_t>(line.tag->measurement);
  const std::vector<double> numbers = layout_numbers(repaired, line.tag->layout);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    parts.push_back({number_field(line, first + k).text, shortest(numbers[k])});
  }
  repairs.replace(CheckCode::kInformationIndefinite, line.line, parts,
                  "raised the negative eigenvalue of the information (" +
                      readable(eigenvalues(omega).minCoeff()) + ") to zero");
}

std::string other_order_hint(const RawGraph& graph, const RawLine& line) {
  if (line.tag->information != 3 || line.tag->measurement != 3) return {};
  const bool toro = line.tag->layout == InformationLayout::kToro2;
  if (!toro && line.tag->layout != InformationLayout::kUpperTriangle) return {};
  std::array<double, 6> numbers{};
  std::copy_n(graph.information(line).begin(), 6, numbers.begin());
  if (!is_positive_semidefinite<3>(
          planar_information(numbers, toro ? PlanarOrder::kRowMajor : PlanarOrder::kToro)))
    return {};
  return toro ? "; read in g2o's order (xx xy xt yy yt tt) it would be"
              : "; read in TORO's order (xx xy yy tt xt yt) it would be";
}

void report_indefinite(const RawGraph& graph, const RawLine& line, const Eigen::MatrixXd& omega,
                       Findings& findings) {
  const Field field = number_field(line, static_cast<std::size_t>(line.tag->measurement));
  std::string hint =
      "information is the inverse of a covariance: check the order of its columns and the signs of "
      "its diagonal";
  if (clamped(omega).size() > 0)
    hint = "it misses by rounding: write more digits; --fix raises the eigenvalue to zero";
  findings.add(CheckCode::kInformationIndefinite, line.line, field.column,
               "information of " + describe(line) +
                   " is not positive semidefinite: its smallest eigenvalue is " +
                   readable(eigenvalues(omega).minCoeff()),
               hint + other_order_hint(graph, line));
}

}  // namespace

Eigen::MatrixXd information_matrix(const RawGraph& graph, const RawLine& line) {
  const int n = line.tag->information;
  const std::span<const double> numbers = graph.information(line);
  if (numbers.empty()) return Eigen::MatrixXd::Identity(n, n);
  if (line.tag->layout == InformationLayout::kToro2) {
    std::array<double, 6> six{};
    std::copy_n(numbers.begin(), 6, six.begin());
    return planar_information(six, PlanarOrder::kToro);
  }
  const Eigen::MatrixXd upper = upper_triangular(numbers, n);
  if (line.tag->layout == InformationLayout::kSquareRootFactor) return upper.transpose() * upper;
  Eigen::MatrixXd omega = upper.selfadjointView<Eigen::Upper>();
  return omega;
}

void check_information(RawGraph& graph, Findings& findings, Repairs& repairs) {
  std::size_t singular = 0;
  const RawLine* first_singular = nullptr;
  for (RawLine& line : graph.lines) {
    if (line.broken || !graph.is_edge(line) || line.tag->information == 0) continue;
    const Eigen::MatrixXd omega = information_matrix(graph, line);
    const Field field = number_field(line, static_cast<std::size_t>(line.tag->measurement));
    if (!omega.allFinite()) {
      line.broken = true;
      findings.add(CheckCode::kNotFinite, line.line, field.column,
                   "information of " + describe(line) + " overflows when it is multiplied out",
                   "write standard deviations of a sensible size");
    } else if (!is_accepted(omega, line.tag->layout)) {
      line.broken = true;
      report_indefinite(graph, line, omega, findings);
      repair(line, omega, repairs);
    } else if (omega.isZero(0.0)) {
      findings.add(CheckCode::kInformationZero, line.line, field.column,
                   "information of " + describe(line) + " is zero: the edge measures nothing",
                   "delete the edge");
    } else if (Eigen::LLT<Eigen::MatrixXd>(omega).info() != Eigen::Success) {
      if (singular++ == 0) first_singular = &line;
    }
  }
  if (!first_singular) return;
  findings.add(
      CheckCode::kInformationSemidefinite, first_singular->line, 1,
      "information of " + describe(*first_singular) +
          " is singular: the edge leaves a direction free" +
          (singular > 1 ? " (and " + std::to_string(singular - 1) + " more edges)" : std::string()),
      "nothing to do if that is meant");
}

}  // namespace cairn
