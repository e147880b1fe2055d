// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "cairn/maps/map_image.hpp"

namespace cairn {

/// The gray levels of map_server: 0 occupied, 254 free, 205 unknown; the upper row first.
std::string gray_levels(const MapImage& map);
/// A binary PGM (P5) of them.
std::string write_pgm(const MapImage& map);
/// What lies beside it: `image` is the picture's path as seen from the YAML file. kUsage where that
/// has control characters.
Result<std::string> write_map_yaml(const MapImage& map, const std::string& image);

/// What a map's YAML file says.
struct MapYaml {
  std::string image;
  double resolution_m = 0.0;
  Se2 T_map_image;
  bool negate = false;
  double occupied_thresh = 0.0, free_thresh = 0.0;
};

/// Keys and rules: README.md. Errors name file:line:column.
Result<MapYaml> read_map_yaml(std::string_view text, const std::string& name);
/// P5 or P2 with at most 255 gray levels, which become cells as `yaml` says.
Result<MapImage> read_pgm(std::string_view bytes, const std::string& name, const MapYaml& yaml);
/// A YAML file and the PGM that it names.
Result<MapImage> read_map(const std::string& yaml_path);

}  // namespace cairn
