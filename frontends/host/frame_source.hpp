// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "cairn/core/result.hpp"
#include "frontends/host/host_observer.hpp"

namespace cairn {

struct NothingYet {};
struct EndOfInput {};
/// What a source says when it is asked for its next frame.
using NextFrame = std::variant<SensorFrame, NothingYet, EndOfInput>;

/// Where frames come from. One thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// A live source waits for about a tenth of a second, then says that there is nothing yet.
  virtual Result<NextFrame> next() = 0;
  /// Frames come when the world sends them, and never the same twice.
  [[nodiscard]] virtual bool is_live() const { return false; }
  /// Who of the source is to be told what becomes of its frames; or null.
  [[nodiscard]] virtual HostObserver* observer() { return nullptr; }
  /// Where the sensor truly was at each frame, as lines of a TUM trajectory; empty: nobody knows.
  [[nodiscard]] virtual std::string truth() const { return {}; }
  /// What to tell at the end, such as frames that were lost; empty: nothing.
  [[nodiscard]] virtual std::string report() const { return {}; }
};

/// The same frames as if the robot had no odometry.
std::unique_ptr<FrameSource> without_odometry(std::unique_ptr<FrameSource> source);

/// "simulated" or "simulated:SEED": a drive through an office floor. "ros" or "ros:KEY=VALUE,...":
/// a robot's topics (frontends/ros). Anything else is the path of a CARMEN log. What a log's reader
/// warns of goes to standard error. `domain` is that of the Cairn daemon.
Result<std::unique_ptr<FrameSource>> open_input(const std::string& name, std::uint32_t domain);

}  // namespace cairn
