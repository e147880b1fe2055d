// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "cairn/core/ids.hpp"
#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn {

/// Where a sensor sits on its body. Files name the mounting (PARAMS_SE2OFFSET, PARAMS_SE3OFFSET);
/// the factor keeps that name, so that it is written back as it was read, and the value, so that
/// evaluation needs no look-up.
template <class Pose>
struct SensorOffset {
  Pose T_body_sensor{};
  std::optional<ParameterId>
      parameter{};  ///< none: the sensor is at the body, or the file has no name for it
};

}  // namespace cairn
