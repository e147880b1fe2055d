// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontends/api/frontend.hpp"

namespace cairn {

/// Told by the host what its front-end does, from the thread that calls run().
class HostObserver {
 public:
  virtual ~HostObserver() = default;

  /// Frames from here on belong to this odometry frame.
  virtual void on_epoch(const OdometryFrame& frame) = 0;
  virtual void on_keyframe(const Transaction& keyframe) = 0;
  /// Optimized poses, of all robots.
  virtual void on_snapshot(const MapSnapshot& snapshot) = 0;
  /// A frame was processed; its keyframe was told before.
  virtual void on_localized(const SensorFrame& frame, const LocalizedFrame& where) = 0;
};

}  // namespace cairn
