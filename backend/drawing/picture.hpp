// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/core/result.hpp"

namespace cairn {

/// What every picture has. The path decides the kind: .png or .svg.
struct PictureOptions {
  std::string title{};
  int width_px = 1600;
  int height_px = 900;
};

/// Refuses a path that is neither .png nor .svg, and sizes outside [200, 16384]. For checks before
/// long work.
Result<void> check_picture(const std::string& path, const PictureOptions& options = {});

}  // namespace cairn
