// SPDX-License-Identifier: BSD-3-Clause
// The normal equations of the two factors that most of every graph is made of, two factors at a
// time.
#include "cairn/factors/between.hpp"
#include "cairn/factors/lanes.hpp"

namespace cairn {
namespace {

using namespace lanes;

// With E = Z^-1 T_a_b the error is rotated into the axes of a: e' = (t_a_b - t_Z, theta), weighed
// with Omega' = (R_Z, 1) Omega (R_Z, 1)^T. There J_b = (R_a_b, 1) and J_a = -(1, q; 0, 1) with q =
// (-y, x) of t_a_b.
class PlanarKernel {
 public:
  using Factor = BetweenSe2;
  static constexpr int kDim = 3;
  static constexpr auto kPoses = &Values::pose2;

  PlanarKernel(const Factor& f0, const Factor& f1, const Se2& a0, const Se2& a1, const Se2& b0,
               const Se2& b1) {
    const Pair ca = load(a0.rotation().cos(), a1.rotation().cos());
    const Pair sa = load(a0.rotation().sin(), a1.rotation().sin());
    const Pair cb = load(b0.rotation().cos(), b1.rotation().cos());
    const Pair sb = load(b0.rotation().sin(), b1.rotation().sin());
    const Pair dx = load(b0.x(), b1.x()) - load(a0.x(), a1.x());
    const Pair dy = load(b0.y(), b1.y()) - load(a0.y(), a1.y());
    c_ = ca * cb + sa * sb;
    s_ = ca * sb - sa * cb;
    x_ = ca * dx + sa * dy;
    y_ = ca * dy - sa * dx;
    const Se2 &z0 = f0.T_a_b_measured, &z1 = f1.T_a_b_measured;
    cz_ = load(z0.rotation().cos(), z1.rotation().cos());
    sz_ = load(z0.rotation().sin(), z1.rotation().sin());
    const Pair px = x_ - load(z0.x(), z1.x()), py = y_ - load(z0.y(), z1.y());
    const auto omega = [&](int row, int col) {
      return load(f0.information(row, col), f1.information(row, col));
    };
    xx_ = omega(0, 0), xy_ = omega(0, 1), yy_ = omega(1, 1);
    xt_ = omega(0, 2), yt_ = omega(1, 2), tt_ = omega(2, 2);
    const Pair theta = load(wrap_angle(b0.theta() - a0.theta() - z0.theta()),
                            wrap_angle(b1.theta() - a1.theta() - z1.theta()));
    const Pair ex = cz_ * px + sz_ * py, ey = cz_ * py - sz_ * px;
    gx_ = xx_ * ex + xy_ * ey + xt_ * theta;
    gy_ = xy_ * ex + yy_ * ey + yt_ * theta;
    gt_ = xt_ * ex + yt_ * ey + tt_ * theta;
    squared_error_ = ex * gx_ + ey * gy_ + theta * gt_;
  }

  [[nodiscard]] Pair squared_error() const { return squared_error_; }

  void scale(Pair weight) {
    for (Pair* entry : {&xx_, &xy_, &yy_, &xt_, &yt_, &tt_, &gx_, &gy_, &gt_}) *entry *= weight;
  }

  void write(const Destination& to_a, const Destination& to_b, const Destination& to_ab) const {
    // A symmetric [xx xy; xy yy] turned by the angle of (c, s).
    const auto turn = [](Pair c, Pair s, Pair xx, Pair xy, Pair yy, Pair* out) {
      const Pair cc = c * c, ss = s * s, cs = c * s, mixed = 2.0 * cs * xy;
      out[0] = cc * xx - mixed + ss * yy;
      out[1] = cs * (xx - yy) + (cc - ss) * xy;
      out[2] = ss * xx + mixed + cc * yy;
    };
    Pair A[3], B[3];
    turn(cz_, sz_, xx_, xy_, yy_, A);
    turn(c_, -s_, A[0], A[1], A[2], B);
    const Pair bx = cz_ * xt_ - sz_ * yt_, by = sz_ * xt_ + cz_ * yt_;
    const Pair gx = cz_ * gx_ - sz_ * gy_, gy = sz_ * gx_ + cz_ * gy_;
    const Pair qx = -y_, qy = x_;
    const Pair ux = A[0] * qx + A[1] * qy + bx, uy = A[1] * qx + A[2] * qy + by;
    const Pair v = qx * bx + qy * by + tt_;
    store(to_a, 0, Vec3{A[0], A[1], ux});
    store(to_a, 3, Vec3{A[1], A[2], uy});
    store(to_a, 6, Vec3{ux, uy, qx * ux + qy * uy + v});
    store(to_a, 9, Vec3{-gx, -gy, -(qx * gx + qy * gy + gt_)});
    store(to_ab, 0, -Vec3{A[0] * c_ + A[1] * s_, A[1] * c_ + A[2] * s_, ux * c_ + uy * s_});
    store(to_ab, 3, Vec3{A[0] * s_ - A[1] * c_, A[1] * s_ - A[2] * c_, ux * s_ - uy * c_});
    store(to_ab, 6, -Vec3{bx, by, v});
    const Pair dx = c_ * bx + s_ * by, dy = c_ * by - s_ * bx;
    store(to_b, 0, Vec3{B[0], B[1], dx});
    store(to_b, 3, Vec3{B[1], B[2], dy});
    store(to_b, 6, Vec3{dx, dy, tt_});
    store(to_b, 9, Vec3{c_ * gx + s_ * gy, c_ * gy - s_ * gx, gt_});
  }

 private:
  Pair c_, s_, x_, y_;                // T_a_b
  Pair cz_, sz_;                      // R_Z
  Pair xx_, xy_, yy_, xt_, yt_, tt_;  // Omega
  Pair gx_, gy_, gt_;                 // Omega e
  Pair squared_error_;
};

// As above in space: e' = (t_a_b - t_Z, 2 vec(q)) with q the quaternion of R_Z^T R_a_b, w >= 0.
// With Q = w I + [vec]x, J_b = (R, Q) and J_a = -(I, -[t]x; 0, Q R^T), where R, t = T_a_b.
class SpatialKernel {
 public:
  using Factor = BetweenSe3;
  static constexpr int kDim = 6;
  static constexpr auto kPoses = &Values::pose3;

  SpatialKernel(const Factor& f0, const Factor& f1, const Se3& a0, const Se3& a1, const Se3& b0,
                const Se3& b1) {
    const Quaternion q_a_map = conjugate(rotation(a0, a1));
    q_a_b_ = q_a_map * rotation(b0, b1);
    const Quaternion q_z = rotation(f0.T_a_b_measured, f1.T_a_b_measured);
    q_error_ = conjugate(q_z) * q_a_b_;
    const Pair sign = load(q_error_.w[0] < 0.0 ? -1.0 : 1.0, q_error_.w[1] < 0.0 ? -1.0 : 1.0);
    q_error_ = {q_error_.x * sign, q_error_.y * sign, q_error_.z * sign, q_error_.w * sign};
    t_ = rotation_matrix(q_a_map) * (translation(b0, b1) - translation(a0, a1));
    R_z_ = rotation_matrix(q_z);
    const Vec3 e_t = transposed_times(R_z_, t_ - translation(f0.T_a_b_measured, f1.T_a_b_measured));
    const Vec3 e_r{q_error_.x + q_error_.x, q_error_.y + q_error_.y, q_error_.z + q_error_.z};
    tt_ = block(f0.information, f1.information, 0, 0);
    tr_ = block(f0.information, f1.information, 0, 3);
    rr_ = block(f0.information, f1.information, 3, 3);
    g_t_ = tt_ * e_t + tr_ * e_r;
    g_r_ = transposed_times(tr_, e_t) + rr_ * e_r;
    squared_error_ = dot(e_t, g_t_) + dot(e_r, g_r_);
  }

  [[nodiscard]] Pair squared_error() const { return squared_error_; }

  void scale(Pair weight) {
    tt_ = tt_ * weight, tr_ = tr_ * weight, rr_ = rr_ * weight;
    g_t_ = g_t_ * weight, g_r_ = g_r_ * weight;
  }

  void write(const Destination& to_a, const Destination& to_b, const Destination& to_ab) const {
    const Mat3 R = rotation_matrix(q_a_b_);
    const Quaternion& q = q_error_;
    const Mat3 Q{{q.w, q.z, -q.y}, {-q.z, q.w, q.x}, {q.y, -q.x, q.w}};
    const Mat3 R_z_T = transpose(R_z_);
    const Mat3 A = symmetric_transposed_times(R_z_T, tt_ * R_z_T);
    const Mat3 BQ = R_z_ * (tr_ * Q);
    const Mat3 AR = A * R;
    const Mat3 N = transposed_times(R, BQ);
    const Mat3 D = symmetric_transposed_times(Q, rr_ * Q);
    const Vec3 g_t = R_z_ * g_t_, Qg = transposed_times(Q, g_r_);
    store(to_b, 0, 6, symmetric_transposed_times(R, AR));
    store(to_b, 3, 6, transpose(N));
    store(to_b, 18, 6, N);
    store(to_b, 21, 6, D);
    store(to_b, 36, transposed_times(R, g_t));
    store(to_b, 39, Qg);

    const Mat3 RD = R * D;
    store(to_ab, 0, 6, -AR);
    store(to_ab, 18, 6, -BQ);
    store(to_ab, 3, 6, -(skew_times(t_, AR) + R * transpose(N)));
    store(to_ab, 21, 6, -(skew_times(t_, BQ) + RD));

    const Mat3 R_T = transpose(R);
    const Mat3 BP = BQ * R_T;  // P = Q R^T
    const Mat3 K = BP - times_skew(A, t_);
    store(to_a, 0, 6, A);
    store(to_a, 3, 6, transpose(K));
    store(to_a, 18, 6, K);
    store(to_a, 21, 6, skew_times(t_, K) + transpose(skew_times(t_, BP)) + RD * R_T);
    store(to_a, 36, -g_t);
    store(to_a, 39, -(cross(t_, g_t) + R * Qg));
  }

 private:
  static Quaternion rotation(const Se3& T0, const Se3& T1) {
    const Eigen::Quaterniond &q0 = T0.rotation().quaternion(), &q1 = T1.rotation().quaternion();
    return {load(q0.x(), q1.x()), load(q0.y(), q1.y()), load(q0.z(), q1.z()), load(q0.w(), q1.w())};
  }
  static Vec3 translation(const Se3& T0, const Se3& T1) {
    const Eigen::Vector3d &t0 = T0.translation(), &t1 = T1.translation();
    return {load(t0.x(), t1.x()), load(t0.y(), t1.y()), load(t0.z(), t1.z())};
  }
  static Mat3 block(const Matrix6d& M0, const Matrix6d& M1, int row, int col) {
    const auto column = [&](int c) {
      return Vec3{load(M0(row, c), M1(row, c)), load(M0(row + 1, c), M1(row + 1, c)),
                  load(M0(row + 2, c), M1(row + 2, c))};
    };
    return {column(col), column(col + 1), column(col + 2)};
  }

  Quaternion q_a_b_, q_error_;
  Vec3 t_;
  Mat3 R_z_, tt_, tr_, rr_;
  Vec3 g_t_, g_r_;
  Pair squared_error_;
};

// Factors i and j at the values.
template <class Kernel>
Kernel kernel_at(const TypedBatch<typename Kernel::Factor>& batch, std::size_t i, std::size_t j,
                 const Values& values) {
  const std::uint32_t* at = batch.variable_indices().data();
  const auto& poses = values.*Kernel::kPoses;
  return Kernel(batch.factor(i), batch.factor(j), poses[at[2 * i]], poses[at[2 * j]],
                poses[at[2 * i + 1]], poses[at[2 * j + 1]]);
}

template <class Kernel>
[[gnu::flatten]] void squared_errors(const TypedBatch<typename Kernel::Factor>& batch,
                                     std::size_t begin, std::size_t end, const Values& values,
                                     double* out) {
  for (std::size_t i = begin; i < end; i += 2) {
    const std::size_t j = std::min(i + 1, end - 1);  // an odd last factor goes through both lanes
    const Pair s = kernel_at<Kernel>(batch, i, j, values).squared_error();
    *out++ = s[0];
    if (j != i) *out++ = s[1];
  }
}

template <int kDim>
void copy_block(const double* block, double* blocks,
                const NormalEquationTargets::OffDiagonal& target) {
  if (target.offset == NormalEquationTargets::kSkip) return;
  using Block = Eigen::Matrix<double, kDim, kDim>;
  const Eigen::Map<const Block, Eigen::Aligned16> from(block);
  Eigen::Map<Block, 0, Eigen::OuterStride<>> to(blocks + target.offset,
                                                Eigen::OuterStride<>(target.leading_dimension));
  if (target.transposed) {
    to = from.transpose();
  } else {
    to = from;
  }
}

template <class Kernel>
[[gnu::flatten]] RangeCost linearize_range(const TypedBatch<typename Kernel::Factor>& batch,
                                           std::size_t begin, std::size_t end,
                                           const EvaluationContext& context,
                                           const NormalEquationTargets& targets) {
  constexpr int kDim = Kernel::kDim;
  alignas(16) double block0[kDim * kDim], block1[kDim * kDim];
  double unused[kDim * kDim + kDim];  // for the diagonal blocks of held variables
  RangeCost sum;
  const auto weight = [&](std::size_t i, double s) {
    sum.chi2 += s;
    const RobustLoss::Value loss =
        context.robust(batch.kinds()[i]) ? context.loss.evaluate(s) : RobustLoss::Value{s, 1.0};
    sum.cost += 0.5 * loss.rho;
    return loss.weight;
  };
  const auto place = [&](std::size_t i) {
    const std::size_t offset = targets.diagonal_offset[i];
    return offset == NormalEquationTargets::kSkip ? unused : targets.diagonal + offset;
  };
  for (std::size_t i = begin; i < end; i += 2) {
    const std::size_t j = std::min(i + 1, end - 1);
    Kernel kernel = kernel_at<Kernel>(batch, i, j, context.values);
    const Pair s = kernel.squared_error();
    const double w0 = weight(i, s[0]);
    const double w1 = j == i ? w0 : weight(j, s[1]);
    if (w0 != 1.0 || w1 != 1.0) kernel.scale(load(w0, w1));
    kernel.write({place(2 * i), place(2 * j)}, {place(2 * i + 1), place(2 * j + 1)},
                 {block0, block1});
    copy_block<kDim>(block0, targets.blocks, targets.off_diagonal[i]);
    copy_block<kDim>(block1, targets.blocks, targets.off_diagonal[j]);
  }
  return sum;
}

}  // namespace

void BetweenSe2::squared_errors(const TypedBatch<BetweenSe2>& batch, std::size_t begin,
                                std::size_t end, const Values& values, double* out) {
  cairn::squared_errors<PlanarKernel>(batch, begin, end, values, out);
}

RangeCost BetweenSe2::linearize(const TypedBatch<BetweenSe2>& batch, std::size_t begin,
                                std::size_t end, const EvaluationContext& context,
                                const NormalEquationTargets& targets) {
  return linearize_range<PlanarKernel>(batch, begin, end, context, targets);
}

void BetweenSe3::squared_errors(const TypedBatch<BetweenSe3>& batch, std::size_t begin,
                                std::size_t end, const Values& values, double* out) {
  cairn::squared_errors<SpatialKernel>(batch, begin, end, values, out);
}

RangeCost BetweenSe3::linearize(const TypedBatch<BetweenSe3>& batch, std::size_t begin,
                                std::size_t end, const EvaluationContext& context,
                                const NormalEquationTargets& targets) {
  return linearize_range<SpatialKernel>(batch, begin, end, context, targets);
}

}  // namespace cairn
