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

/// The scans of a CARMEN log.
Result<std::unique_ptr<FrameSource>> open_log(const std::string& path);

}  // namespace cairn
