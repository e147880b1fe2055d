// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cairn::test {

/// Width and height of a PNG file in memory; nothing when signature, header or end are not those of
/// a PNG.
inline std::optional<std::pair<int, int>> png_size(const std::string& bytes) {
  const std::string signature = "\x89PNG\r\n\x1a\n";
  if (bytes.size() < 45 || bytes.compare(0, 8, signature) != 0 || bytes.compare(12, 4, "IHDR") != 0)
    return {};
  if (bytes.compare(bytes.size() - 8, 4, "IEND") != 0) return {};
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k)
      value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return static_cast<int>(value);
  };
  return std::pair(number(16), number(20));
}

/// True when every element of the XML text is closed in order and the root is <svg>. No full XML
/// parser: enough for what a drawing library writes.
inline bool is_well_formed_svg(const std::string& text) {
  std::vector<std::string> open;
  bool seen_svg = false;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = text.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag.empty() || tag[0] == '?' || tag[0] == '!') continue;
    const std::string name = tag.substr(0, tag.find_first_of(" \n/", 1));
    if (tag[0] == '/') {
      if (open.empty() || "/" + open.back() != tag) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      if (open.empty() && name != "svg") return false;
      seen_svg = true;
      open.push_back(name);
    }
  }
  return seen_svg && open.empty();
}

}  // namespace cairn::test
