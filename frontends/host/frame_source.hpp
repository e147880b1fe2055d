// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cairn/core/result.hpp"
#include "frontends/api/frontend.hpp"

namespace cairn {

/// Where frames come from.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Nothing: the input has ended.
  virtual Result<std::optional<SensorFrame>> next() = 0;
};

/// "simulated" or "simulated:SEED": a drive through an office floor; anything else is the path of a
/// CARMEN log. What a log's reader warns of goes to standard error.
Result<std::unique_ptr<FrameSource>> open_input(const std::string& name);

}  // namespace cairn
