// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/drawing/gray_image.hpp"
#include "cairn/history/export.hpp"
#include "cairn/maps/map_image.hpp"

namespace cairn::cli {

/// A map as files: an image, and map_server's YAML beside it.
struct MapPaths {
  std::string image, yaml;
};
/// From OUT.pgm, OUT.png, or OUT.yaml (an OUT.pgm); kUsage for other names.
Result<MapPaths> map_paths(const std::string& out);
Result<NamedFiles> map_files(const MapPaths& paths, const MapImage& map);

GrayImage to_gray(const MapImage& map);

}  // namespace cairn::cli
