// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/copy_filter.hpp"

#include <cmath>

namespace cairn {
namespace {

constexpr double kTolerance =
    1e-5;  // m, rad, quaternion components; files are written with six digits

double difference(const TagSpec& tag, int column, double a, double b) {
  const bool is_angle = (tag.angles >> column & 1u) != 0;
  return std::abs(is_angle ? wrap_angle(a - b) : a - b);
}

bool are_close(const TagSpec& tag, const double* a, const double* b) {
  double dot = 0.0;  // q and -q are one rotation
  for (int c = tag.quaternion; c >= 0 && c < tag.quaternion + 4; ++c) dot += a[c] * b[c];
  for (int c = 0; c < tag.measurement; ++c) {
    const bool flipped = dot < 0.0 && c >= tag.quaternion && c < tag.quaternion + 4;
    if (difference(tag, c, a[c], flipped ? -b[c] : b[c]) > kTolerance) return false;
  }
  return true;
}

}  // namespace

bool CopyFilter::is_copy(std::size_t text, const TagSpec& tag, std::span<const VariableId> ids,
                         std::span<const double> measurement) {
  const Ids key{ids.front(), ids.back()};
  const auto found = newest_.find(key);
  const std::size_t newest = found == newest_.end() ? kNone : found->second;
  for (std::size_t e = newest; e != kNone; e = entries_[e].older) {
    const Entry& entry = entries_[e];
    const bool other_file = entry.text != text && entry.tag == &tag;
    if (other_file && are_close(tag, measurement.data(), &numbers_[entry.measurement])) return true;
  }
  newest_[key] = entries_.size();
  entries_.push_back({text, &tag, numbers_.size(), newest});
  numbers_.insert(numbers_.end(), measurement.begin(), measurement.end());
  return false;
}

}  // namespace cairn
