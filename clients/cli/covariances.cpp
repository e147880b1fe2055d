// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/covariances.hpp"

#include <charconv>
#include <cmath>

#include "cairn/solver/marginals.hpp"

namespace cairn::cli {
namespace {

// Shortest digits that read back to the same number.
void append(std::string& text, double value) {
  if (std::isnan(value)) return void(text += "nan");
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace

Result<std::string> covariance_text(const Graph& graph, const SolveOptions& options) {
  Result<Marginals> marginals = Marginals::compute(graph, options);
  if (!marginals) return marginals.error();
  std::string text;
  for (VariableSlot slot = 0; slot < graph.variables().size(); ++slot) {
    const Variable& variable = graph.variables()[slot];
    const Eigen::MatrixXd covariance = marginals->covariance(slot);
    text += std::to_string(variable.id.value) + "," + std::to_string(covariance.rows());
    for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
      for (Eigen::Index column = row; column < covariance.cols(); ++column) {
        text += ',';
        append(text, covariance(row, column));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace cairn::cli
