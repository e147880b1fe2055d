// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/map_text.hpp"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cairn {
namespace {

constexpr std::string_view kSigns = "?.#";  // by CellState
constexpr std::size_t kMaxCells = std::size_t{1} << 30;

Result<MapImage> parse_header(std::string_view line) {
  const Error no_map{ErrorCode::kBadInput,
                     "the answer holds no map; do client and daemon have the same version?"};
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return no_map;
  const auto whole = [&](const char* key) -> std::size_t {
    const auto found = json.find(key);
    return found != json.end() && found->is_number_unsigned() ? found->get<std::size_t>() : 0;
  };
  const auto real = [](const nlohmann::json& number) {
    return number.is_number() ? number.get<double>() : std::nan("");
  };
  MapImage map;
  map.width = whole("width");
  map.height = whole("height");
  map.resolution_m = json.contains("resolution_m") ? real(json["resolution_m"]) : 0.0;
  const auto origin = json.find("origin");
  if (map.width == 0 || map.height == 0 || map.width > kMaxCells / map.height ||
      !(map.resolution_m > 0.0) || origin == json.end() || !origin->is_array() ||
      origin->size() != 3)
    return no_map;
  const Eigen::Vector3d corner(real((*origin)[0]), real((*origin)[1]), real((*origin)[2]));
  if (!corner.allFinite()) return no_map;
  map.T_map_image = Se2(corner.x(), corner.y(), corner.z());
  return map;
}

}  // namespace

std::string to_text(const MapImage& map) {
  const nlohmann::json header{
      {"width", map.width},
      {"height", map.height},
      {"resolution_m", map.resolution_m},
      {"origin", {map.T_map_image.x(), map.T_map_image.y(), map.T_map_image.theta()}}};
  std::string text = header.dump() + '\n';
  for (std::size_t i = 0, next = 0; i < map.cells.size(); i = next) {
    while (next < map.cells.size() && map.cells[next] == map.cells[i]) ++next;
    if (next - i > 1) text += std::to_string(next - i);
    text += kSigns[static_cast<std::size_t>(map.cells[i])];
  }
  return text;
}

Result<MapImage> parse_map_text(std::string_view text) {
  const std::size_t line = std::min(text.find('\n'), text.size());
  Result<MapImage> map = parse_header(text.substr(0, line));
  if (!map) return map;
  const std::size_t expected = map->width * map->height;
  const char* at = text.data() + std::min(line + 1, text.size());
  const char* end = text.data() + text.size();
  while (at != end) {
    std::size_t count = 1;
    const auto [behind, error] = std::from_chars(at, end, count);
    const std::size_t sign = behind == end || error == std::errc::result_out_of_range
                                 ? std::string_view::npos
                                 : kSigns.find(*behind);
    if (sign == std::string_view::npos || count > expected - map->cells.size())
      return Error{ErrorCode::kBadInput, "the cells of the map that was received are damaged"};
    map->cells.insert(map->cells.end(), count, static_cast<CellState>(sign));
    at = behind + 1;
  }
  if (map->cells.size() == expected) return map;
  return Error{ErrorCode::kBadInput, "the map that was received ends too early"};
}

}  // namespace cairn
