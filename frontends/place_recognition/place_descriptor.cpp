// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/place_recognition/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cairn {
namespace {

constexpr double kCell_m = 0.2, kRing_m = 0.5;
constexpr int kRings = 24, kAngles = 5;

std::int64_t cell_of(const Eigen::Vector2d& p) {
  const auto index = [](double m) { return static_cast<std::int64_t>(std::floor(m / kCell_m)); };
  return (index(p.x()) << 32) + index(p.y());
}

// From along the surface to head on; the last one where no line says.
int angle_of(const SurfacePoint& point) {
  if (point.normal.isZero()) return kAngles - 1;
  const double cosine = std::abs(point.normal.dot(point.position.normalized()));
  return std::min(kAngles - 2, static_cast<int>(cosine * (kAngles - 1)));
}

}  // namespace

// A cell counts once, by the first point in it: what is near has more echoes than what is far.
PlaceDescriptor describe_place(const std::vector<SurfacePoint>& points) {
  std::vector<std::pair<std::int64_t, std::size_t>> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = points[i].position.norm();
    if (distance > 0.0 && distance < kRings * kRing_m)
      cells.emplace_back(cell_of(points[i].position), i);
  }
  std::sort(cells.begin(), cells.end());
  PlaceDescriptor histogram = PlaceDescriptor::Zero();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0 && cells[i].first == cells[i - 1].first) continue;
    const SurfacePoint& point = points[cells[i].second];
    // Shared by the two rings whose middles it lies between.
    const double ring = point.position.norm() / kRing_m - 0.5;
    const int low = static_cast<int>(std::floor(ring)), angle = angle_of(point);
    const auto share = static_cast<float>(ring - low);
    if (low >= 0) histogram[low * kAngles + angle] += 1.0f - share;
    if (low + 1 < kRings) histogram[(low + 1) * kAngles + angle] += share;
  }
  histogram = histogram.cwiseSqrt();  // no wall outweighs all else
  const float length = histogram.norm();
  return length > 0.0f ? PlaceDescriptor(histogram / length) : histogram;
}

}  // namespace cairn
