// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "frontends/matching/point_to_line.hpp"

namespace cairn {

/// Watches for stretches of a way on which scans leave a direction free, such as a long corridor:
/// there the map is as good as odometry.
class BlindStretch {
 public:
  /// What is to be told, once where a stretch begins and once where it ends. A few scans in a row
  /// make or end one.
  std::optional<std::string> take(const PointToLineMatch& match, std::size_t keyframe);
  /// About the whole way; empty: no scan left a direction free.
  [[nodiscard]] std::string summary() const;

 private:
  std::size_t scans_ = 0, free_ = 0, stretches_ = 0;
  std::size_t in_a_row_ = 0;  ///< scans that are not as the stretch says
  std::size_t since_ = 0;     ///< scans of this stretch
  bool blind_ = false;
};

}  // namespace cairn
