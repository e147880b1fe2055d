// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "cairn/io/graph_tags.hpp"

namespace cairn {

/// Omega (m, rad) from the information columns of an edge; no columns: the identity. Of a full
/// matrix the symmetric part.
template <int N>
Eigen::Matrix<double, N, N> read_information(InformationLayout layout,
                                             std::span<const double> columns);

/// Appends the columns that read_information takes. Omega = R^T R is settled (settle.hpp). Returns
/// how far what they read as is from Omega: the largest error of an entry i, j relative to
/// sqrt(Omega_ii Omega_jj). Only roots of nearly singular matrices are off.
template <int N>
double write_information(InformationLayout layout, const Eigen::Matrix<double, N, N>& information,
                         std::vector<double>& columns);

}  // namespace cairn
