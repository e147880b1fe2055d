// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/map_files.hpp"

#include <filesystem>

#include "cairn/io/map_file.hpp"

namespace cairn::cli {

Result<MapPaths> map_paths(const std::string& out) {
  const std::filesystem::path path(out);
  const std::string extension = path.extension().string();
  const auto with = [&](const char* ending) {
    return std::filesystem::path(path).replace_extension(ending).string();
  };
  if (extension == ".pgm" || extension == ".png") return MapPaths{out, with(".yaml")};
  if (extension == ".yaml") return MapPaths{with(".pgm"), out};
  return Error{ErrorCode::kUsage, "a map must be named .pgm, .png or .yaml", out};
}

Result<NamedFiles> map_files(const MapPaths& paths, const MapImage& map) {
  const Result<std::string> yaml =
      write_map_yaml(map, std::filesystem::path(paths.image).filename().string());
  if (!yaml) return yaml.error();
  if (paths.image.ends_with(".pgm"))
    return NamedFiles{{paths.image, write_pgm(map)}, {paths.yaml, *yaml}};
  const Result<std::string> png = encode_png(to_gray(map));
  if (!png) return png.error();
  return NamedFiles{{paths.image, *png}, {paths.yaml, *yaml}};
}

GrayImage to_gray(const MapImage& map) { return {map.width, map.height, gray_levels(map)}; }

}  // namespace cairn::cli
