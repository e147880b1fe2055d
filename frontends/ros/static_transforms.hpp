// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "frontends/api/laser_scan.hpp"
#include "idl/dds/ros_topics.hpp"

namespace cairn {

/// A robot's fixed frames, from /tf_static: a forest of frames, each with its parent.
class StaticTransforms {
 public:
  static constexpr std::size_t kMost = 1000;  ///< frames; further ones are left out

  /// Takes the transforms that are sound; a frame that is told again moves.
  void add(const ros::TFMessage& message);
  /// Nothing where no chain of transforms leads from one to the other.
  [[nodiscard]] std::optional<Se3> T_a_b(const std::string& a, const std::string& b) const;

 private:
  struct Link {
    std::string parent;
    Se3 T_parent_child;
  };
  struct Root {
    std::string frame;
    Se3 T_root_frame;
  };
  [[nodiscard]] Root root_of(std::string frame) const;

  std::map<std::string, Link> links_;  ///< by child
};

/// How a laser sits on its robot, seen from above.
struct LaserMount {
  Se2 T_base_laser{};
  bool upside_down = false;
  double tilt_rad = 0.0;  ///< of its axis from the vertical
};
LaserMount to_mount(const Se3& T_base_laser);

/// The scan of a laser that hangs upside down, as one that stands upright at the same place with
/// the same direction ahead would have seen it.
void turn_upright(LaserScan& scan);

}  // namespace cairn
