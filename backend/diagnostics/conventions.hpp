// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cairn {

/// Guesses which convention the writer of a file followed, from the raw numbers of its lines.
/// Nothing here changes what the readers do: a file is read as its format says, and the guess
/// becomes a finding.

/// A planar pose as written: x, y, angle in an unknown unit.
struct RawPose2 {
  double x = 0.0, y = 0.0, angle = 0.0;
};

/// A planar edge as written, between positions in an array of poses.
struct RawEdge2 {
  std::uint32_t from = 0, to = 0;
  RawPose2 measured;
  std::array<double, 6> information{};
};

/// What reading the angles as degrees would do. The misfits are medians over the edges.
struct DegreesVerdict {
  bool vertices = false;  ///< the angles of the poses look like degrees
  bool edges = false;     ///< the angles of the edges look like degrees
  double misfit_as_radians =
      0.0;  ///< of the edges or vertices in doubt: rad (edges) or relative length (vertices)
  double misfit_as_degrees = 0.0;
};

/// `poses` holds what the file says about each vertex the edges name; nothing where the file has no
/// line for it.
DegreesVerdict judge_angle_units(std::span<const std::optional<RawPose2>> poses,
                                 std::span<const RawEdge2> edges);

/// The two ways six numbers become a symmetric 3 x 3 matrix over (x, y, angle).
enum class PlanarOrder {
  kRowMajor,  ///< g2o, iSAM: xx xy xt yy yt tt
  kToro,      ///< xx xy yy tt xt yt
};
Eigen::Matrix3d planar_information(const std::array<double, 6>& numbers, PlanarOrder order);
/// The numbers that mean in `to` what they mean in the other order.
std::array<double, 6> reorder_planar_information(const std::array<double, 6>& numbers,
                                                 PlanarOrder to);

enum class OrderVerdict {
  kAsGiven,    ///< nothing speaks against it
  kPlausible,  ///< both orders are possible, but the residuals fit the other one much better
  kSwapped,    ///< the given order is impossible nearly everywhere, the other one nowhere
};
/// Whether the information of the edges was written in the other order than `given`.
OrderVerdict judge_information_order(std::span<const std::optional<RawPose2>> poses,
                                     std::span<const RawEdge2> edges, PlanarOrder given);

/// True when quaternions read as x y z w turn by nearly half a turn at every step, and hardly at
/// all read as w x y z.
bool quaternions_look_w_first(std::span<const Eigen::Vector4d> edge_quaternions);

}  // namespace cairn
