// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/information_columns.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/io/settle.hpp"

namespace cairn {
namespace {

template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

// TORO 2-D: ff fs ss rr fr sr, with f = x, s = y, r = theta.
constexpr int kToro2Order[6][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}};

template <int N>
Matrix<N> from_upper_triangle(std::span<const double> columns) {
  Matrix<N> m;
  const double* next = columns.data();
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) m(i, j) = m(j, i) = *next++;
  }
  return m;
}

template <int N>
void append_upper_triangle(const Matrix<N>& m, std::vector<double>& columns) {
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) columns.push_back(m(i, j));
  }
}

// g2o's SE(3) error takes the imaginary part of the quaternion, half the angle: a rotation block
// for it weighs radians by a quarter. Powers of two: exact, and exactly undone.
void scale_rotation(Matrix<6>& m, double factor) {
  m.topRightCorner<3, 3>() *= factor;
  m.bottomLeftCorner<3, 3>() *= factor;
  m.bottomRightCorner<3, 3>() *= factor * factor;
}

// Upper triangles as vectors, so that they compare and order.
template <int N>
Matrix<N> square(std::span<const double> root) {
  Matrix<N> R = Matrix<N>::Zero();
  const double* next = root.data();
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) R(i, j) = *next++;
  }
  Matrix<N> omega;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      double sum = 0.0;
      for (int k = 0; k <= i; ++k) sum += R(k, i) * R(k, j);
      omega(i, j) = omega(j, i) = sum;
    }
  }
  return omega;
}

// To the decimal place of `precision` or the next above it; without negative zeros.
double round_to(double x, double precision) {
  const int decimals = -static_cast<int>(std::ceil(std::log10(precision)));
  const double scale = std::pow(10.0, std::abs(decimals));
  return (decimals >= 0 ? std::round(x * scale) / scale : std::round(x / scale) * scale) + 0.0;
}

// R with R^T R = Omega; a row of zeros where Omega has lost a rank. Omega holds its entries to
// 1e-16 of the lengths l_i l_j of the columns of R, and what a row divides by its pivot it knows
// that much less well: each entry is rounded to 1e-14 l_i l_j / R_ii, before the next rows build on
// it. So squaring R and taking the root again finds the same places, and the same digits.
template <int N>
std::vector<double> square_root(const Matrix<N>& omega) {
  constexpr double kPrecision = 1e-14, kRankLoss = 1e-13;
  constexpr double kSmallest = 1e-290;  // below, squares lose digits
  const auto length = [&](int i) { return std::sqrt(std::max(omega(i, i), kSmallest)); };
  Matrix<N> R = Matrix<N>::Zero();
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      double rest = omega(i, j);
      for (int k = 0; k < i; ++k) rest -= R(k, i) * R(k, j);
      if (j == i && rest <= std::max(kRankLoss * omega(i, i), kSmallest)) break;
      const double entry = j == i ? std::sqrt(rest) : rest / R(i, i);
      const double pivot = j == i ? entry : R(i, i);
      R(i, j) = round_to(entry, kPrecision * length(i) * length(j) / pivot);
    }
  }
  std::vector<double> root;
  append_upper_triangle<N>(R, root);
  return root;
}

template <int N>
double largest_error(const Matrix<N>& found, const Matrix<N>& expected) {
  double largest = 0.0;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      const double error = std::abs(found(i, j) - expected(i, j));
      if (error > 0.0)
        largest = std::max(largest, error / std::sqrt(expected(i, i)) / std::sqrt(expected(j, j)));
    }
  }
  return largest;
}

}  // namespace

template <int N>
Matrix<N> read_information(InformationLayout layout, std::span<const double> columns) {
  if (columns.empty()) return Matrix<N>::Identity();
  switch (layout) {
    case InformationLayout::kFullMatrix: {
      const Eigen::Map<const Matrix<N>> m(columns.data());
      return 0.5 * (m + m.transpose());
    }
    case InformationLayout::kSquareRootFactor:
      return square<N>(columns);
    case InformationLayout::kToro2:
      if constexpr (N == 3) {
        Matrix<N> m;
        for (int c = 0; c < 6; ++c) {
          const auto [i, j] = kToro2Order[c];
          m(i, j) = m(j, i) = columns[static_cast<std::size_t>(c)];
        }
        return m;
      }
      break;
    case InformationLayout::kG2oSe3:
      if constexpr (N == 6) {
        Matrix<N> m = from_upper_triangle<N>(columns);
        scale_rotation(m, 0.5);
        return m;
      }
      break;
    case InformationLayout::kUpperTriangle:
      break;
  }
  return from_upper_triangle<N>(columns);
}

template <int N>
double write_information(InformationLayout layout, const Matrix<N>& information,
                         std::vector<double>& columns) {
  if (layout == InformationLayout::kSquareRootFactor) {
    const auto root = settle(square_root<N>(information), [](const std::vector<double>& r) {
      return square_root<N>(square<N>(r));
    });
    columns.insert(columns.end(), root.begin(), root.end());
    return largest_error<N>(square<N>(root), information);
  }
  if constexpr (N == 3) {
    if (layout == InformationLayout::kToro2) {
      for (const auto& [i, j] : kToro2Order) columns.push_back(information(i, j));
      return 0.0;
    }
  }
  if constexpr (N == 6) {
    if (layout == InformationLayout::kG2oSe3) {
      Matrix<N> scaled = information;
      scale_rotation(scaled, 2.0);
      append_upper_triangle<N>(scaled, columns);
      return 0.0;
    }
  }
  append_upper_triangle<N>(information, columns);
  return 0.0;
}

template Matrix<1> read_information<1>(InformationLayout, std::span<const double>);
template Matrix<2> read_information<2>(InformationLayout, std::span<const double>);
template Matrix<3> read_information<3>(InformationLayout, std::span<const double>);
template Matrix<6> read_information<6>(InformationLayout, std::span<const double>);
template double write_information<1>(InformationLayout, const Matrix<1>&, std::vector<double>&);
template double write_information<2>(InformationLayout, const Matrix<2>&, std::vector<double>&);
template double write_information<3>(InformationLayout, const Matrix<3>&, std::vector<double>&);
template double write_information<6>(InformationLayout, const Matrix<6>&, std::vector<double>&);

}  // namespace cairn
