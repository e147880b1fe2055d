// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace cairn::lanes {

/// Two numbers that go through the same arithmetic: one per factor. The hot kernels work on two
/// factors at a time, which every x86-64 does at the price of one. What a lane computes does not
/// depend on its neighbor, so results have the same bits however factors are paired.
/// benchmarks/linearize_speed.cpp shows what it is worth.
using Pair = double __attribute__((vector_size(16)));

inline Pair load(double first, double second) { return Pair{first, second}; }

struct Vec3 {
  Pair x, y, z;
};
inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(const Vec3& a, Pair s) { return {a.x * s, a.y * s, a.z * s}; }
inline Pair dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Columns a, b, c.
struct Mat3 {
  Vec3 a, b, c;
};
inline Mat3 transpose(const Mat3& M) {
  return {{M.a.x, M.b.x, M.c.x}, {M.a.y, M.b.y, M.c.y}, {M.a.z, M.b.z, M.c.z}};
}
inline Mat3 operator+(const Mat3& M, const Mat3& N) { return {M.a + N.a, M.b + N.b, M.c + N.c}; }
inline Mat3 operator-(const Mat3& M, const Mat3& N) { return {M.a - N.a, M.b - N.b, M.c - N.c}; }
inline Mat3 operator-(const Mat3& M) { return {-M.a, -M.b, -M.c}; }
inline Mat3 operator*(const Mat3& M, Pair s) { return {M.a * s, M.b * s, M.c * s}; }
inline Vec3 operator*(const Mat3& M, const Vec3& v) { return M.a * v.x + M.b * v.y + M.c * v.z; }
inline Mat3 operator*(const Mat3& M, const Mat3& N) { return {M * N.a, M * N.b, M * N.c}; }
inline Vec3 transposed_times(const Mat3& M, const Vec3& v) {
  return {dot(M.a, v), dot(M.b, v), dot(M.c, v)};
}
inline Mat3 transposed_times(const Mat3& M, const Mat3& N) {
  return {transposed_times(M, N.a), transposed_times(M, N.b), transposed_times(M, N.c)};
}
/// M^T N where the product is known to be symmetric.
inline Mat3 symmetric_transposed_times(const Mat3& M, const Mat3& N) {
  const Pair xx = dot(M.a, N.a), xy = dot(M.a, N.b), xz = dot(M.a, N.c);
  const Pair yy = dot(M.b, N.b), yz = dot(M.b, N.c), zz = dot(M.c, N.c);
  return {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
}
/// [t]x M and M [t]x.
inline Mat3 skew_times(const Vec3& t, const Mat3& M) {
  return {cross(t, M.a), cross(t, M.b), cross(t, M.c)};
}
inline Mat3 times_skew(const Mat3& M, const Vec3& t) {
  return {M.b * t.z - M.c * t.y, M.c * t.x - M.a * t.z, M.a * t.y - M.b * t.x};
}

struct Quaternion {
  Pair x, y, z, w;
};
inline Quaternion conjugate(const Quaternion& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline Quaternion operator*(const Quaternion& p, const Quaternion& q) {
  return {
      p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y, p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x,
      p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w, p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z};
}
inline Mat3 rotation_matrix(const Quaternion& q) {
  const Pair tx = q.x + q.x, ty = q.y + q.y, tz = q.z + q.z;
  const Pair wx = tx * q.w, wy = ty * q.w, wz = tz * q.w, xx = tx * q.x, xy = ty * q.x,
             xz = tz * q.x;
  const Pair yy = ty * q.y, yz = tz * q.y, zz = tz * q.z;
  return {{1.0 - (yy + zz), xy + wz, xz - wy},
          {xy - wz, 1.0 - (xx + zz), yz + wx},
          {xz + wy, yz - wx, 1.0 - (xx + yy)}};
}

/// Where the two lanes of a column-major matrix go.
struct Destination {
  double* first;
  double* second;
};
inline void store(const Destination& to, int offset, Pair value) {
  to.first[offset] = value[0];
  to.second[offset] = value[1];
}
inline void store(const Destination& to, int offset, const Vec3& v) {
  store(to, offset, v.x);
  store(to, offset + 1, v.y);
  store(to, offset + 2, v.z);
}
inline void store(const Destination& to, int offset, int stride, const Mat3& M) {
  store(to, offset, M.a);
  store(to, offset + stride, M.b);
  store(to, offset + 2 * stride, M.c);
}

}  // namespace cairn::lanes
