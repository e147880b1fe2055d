// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/map_file.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "cairn/io/input_text.hpp"

namespace cairn {
namespace {

constexpr char kFreeLevel = static_cast<char>(254), kUnknownLevel = static_cast<char>(205);
constexpr std::size_t kMaxPixels = std::size_t{1} << 30;

std::string text_of(double number) {
  char digits[40];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '/' || c == '-';
}

Result<std::string> quoted(const std::string& image) {
  if (std::all_of(image.begin(), image.end(), is_plain) && !image.starts_with('-')) return image;
  std::string text = "\"";
  for (const char c : image) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      return Error{ErrorCode::kUsage,
                   "the name of a map must have no control characters; choose another", image};
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

// The numbers in the head of a PGM, between blanks and comments.
class PgmHead {
 public:
  explicit PgmHead(std::string_view bytes) : bytes_(bytes) {}

  /// Nothing where there is none, or one above 2^30.
  std::optional<std::size_t> number() {
    skip_blanks();
    std::size_t value = 0;
    const char* first = bytes_.data() + at_;
    const auto [end, error] = std::from_chars(first, bytes_.data() + bytes_.size(), value);
    if (error != std::errc() || value > kMaxPixels) return std::nullopt;
    at_ += static_cast<std::size_t>(end - first);
    return value;
  }
  void skip(std::size_t count) { at_ = std::min(at_ + count, bytes_.size()); }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  void skip_blanks() {
    constexpr std::string_view kBlanks = " \t\r\n";
    while (at_ < bytes_.size()) {
      if (bytes_[at_] == '#')
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      else if (kBlanks.find(bytes_[at_]) != std::string_view::npos)
        ++at_;
      else
        return;
    }
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

CellState state_of(std::size_t level, std::size_t white, const MapYaml& yaml) {
  const double brightness = static_cast<double>(level) / static_cast<double>(white);
  const double p = yaml.negate ? brightness : 1.0 - brightness;
  if (p > yaml.occupied_thresh) return CellState::kOccupied;
  return p < yaml.free_thresh ? CellState::kFree : CellState::kUnknown;
}

}  // namespace

std::string gray_levels(const MapImage& map) {
  std::string levels;
  levels.reserve(map.cells.size());
  for (std::size_t row = map.height; row-- > 0;) {
    for (std::size_t column = 0; column < map.width; ++column) {
      const CellState state = map.at(column, row);
      levels += state == CellState::kOccupied ? '\0'
                : state == CellState::kFree   ? kFreeLevel
                                              : kUnknownLevel;
    }
  }
  return levels;
}

std::string write_pgm(const MapImage& map) {
  return "P5\n" + std::to_string(map.width) + ' ' + std::to_string(map.height) + "\n255\n" +
         gray_levels(map);
}

Result<std::string> write_map_yaml(const MapImage& map, const std::string& image) {
  const Result<std::string> name = quoted(image);
  if (!name) return name.error();
  const Se2& T = map.T_map_image;
  return "image: " + *name + "\nresolution: " + text_of(map.resolution_m) + "\norigin: [" +
         text_of(T.x()) + ", " + text_of(T.y()) + ", " + text_of(T.theta()) +
         "]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n";
}

Result<MapImage> read_pgm(std::string_view bytes, const std::string& name, const MapYaml& yaml) {
  const auto refuse = [&](std::size_t at, const std::string& why) {
    return Error{ErrorCode::kBadInput, why, name + ": byte " + std::to_string(at)};
  };
  const bool binary = bytes.starts_with("P5");
  if (!binary && !bytes.starts_with("P2"))
    return refuse(0, "expected a PGM file, which begins with P5 or P2; convert the image to PGM");
  PgmHead head(bytes);
  head.skip(2);
  const auto width = head.number(), height = head.number(), white = head.number();
  if (!width || !height || !white || *width == 0 || *height == 0)
    return refuse(head.at(), "expected width, height and the number of the brightest gray level");
  if (*white == 0 || *white > 255)
    return refuse(head.at(),
                  "the brightest gray level is " + std::to_string(*white) + "; expected 1 to 255");
  const std::size_t least_bytes = binary ? 1 : 2;  // of a pixel: with its blank
  if (*width > kMaxPixels / *height || *width * *height > bytes.size() / least_bytes + 1)
    return refuse(bytes.size(), "ends too early for " + std::to_string(*width) + " x " +
                                    std::to_string(*height) + " pixels");
  if (binary) head.skip(1);  // the one blank behind the head

  MapImage map{yaml.resolution_m, yaml.T_map_image, *width, *height, {}};
  map.cells.resize(*width * *height);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const std::size_t at = head.at();
    std::optional<std::size_t> level;
    if (!binary) {
      level = head.number();
    } else if (at < bytes.size()) {
      level = static_cast<unsigned char>(bytes[at]);
      head.skip(1);
    }
    if (!level || *level > *white)
      return refuse(at, "pixel " + std::to_string(i) + " of " + std::to_string(map.cells.size()) +
                            " is no gray level up to " + std::to_string(*white));
    const std::size_t row = *height - 1 - i / *width;
    map.cells[row * *width + i % *width] = state_of(*level, *white, yaml);
  }
  return map;
}

Result<MapImage> read_map(const std::string& yaml_path) {
  const Result<InputText> text = read_input_text(yaml_path);
  if (!text) return text.error();
  const Result<MapYaml> yaml = read_map_yaml(text->view, input_name(yaml_path));
  if (!yaml) return yaml.error();
  const std::string image = (std::filesystem::path(yaml_path).parent_path() / yaml->image).string();
  const Result<InputText> pixels = read_input_text(image);
  if (!pixels) return pixels.error();
  return read_pgm(pixels->view, image, *yaml);
}

}  // namespace cairn
