// SPDX-License-Identifier: BSD-3-Clause
// The YAML files of map_server: lines of `key: value`.
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "cairn/io/map_file.hpp"

namespace cairn {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Without a comment: '#' at the beginning or behind a blank, outside of quotes.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == '\\' && quote == '"')
        ++i;
      else if (c == quote)
        quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return line.substr(0, i);
    }
  }
  return line;
}

std::optional<double> to_number(std::string_view text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
    return std::nullopt;
  return number;
}

std::optional<std::string> to_text(std::string_view value) {
  if (value.empty()) return std::nullopt;
  const char quote = value.front();
  if (quote != '"' && quote != '\'') return std::string(value);
  if (value.size() < 3 || value.back() != quote) return std::nullopt;
  std::string text;
  for (std::size_t i = 1; i + 1 < value.size(); ++i) {
    if (quote == '"' && value[i] == '\\' && i + 2 < value.size()) ++i;
    text += value[i];
  }
  return text;
}

std::optional<std::array<double, 3>> to_origin(std::string_view value) {
  if (value.size() < 2 || value.front() != '[' || value.back() != ']') return std::nullopt;
  value = value.substr(1, value.size() - 2);
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = value.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
    const auto number = to_number(trimmed(value.substr(0, comma)));
    if (!number) return std::nullopt;
    numbers[i] = *number;
    if (i < 2) value = value.substr(comma + 1);
  }
  return numbers;
}

// What a key takes, and who takes it: false where the value is none.
struct Key {
  const char* name;
  const char* expected;
  bool (*take)(std::string_view value, MapYaml& yaml);
};

bool take_number(std::string_view value, double low, double high, double& number) {
  const auto read = to_number(value);
  if (!read || *read < low || *read > high) return false;
  number = *read;
  return true;
}

const std::array kKeys{
    Key{"image", "the name of a picture",
        [](std::string_view value, MapYaml& yaml) {
          const auto text = to_text(value);
          if (text) yaml.image = *text;
          return text.has_value();
        }},
    Key{"resolution", "meters per pixel, from 0.0001 to 1000",
        [](std::string_view value, MapYaml& yaml) {
          return take_number(value, 1e-4, 1e3, yaml.resolution_m);
        }},
    Key{"origin", "[x, y, yaw] of the lower left corner, m and rad",
        [](std::string_view value, MapYaml& yaml) {
          const auto origin = to_origin(value);
          if (origin) yaml.T_map_image = Se2((*origin)[0], (*origin)[1], (*origin)[2]);
          return origin.has_value();
        }},
    Key{"negate", "0 or 1",
        [](std::string_view value, MapYaml& yaml) {
          yaml.negate = value == "1" || value == "true";
          return yaml.negate || value == "0" || value == "false";
        }},
    Key{"occupied_thresh", "a probability from 0 to 1",
        [](std::string_view value, MapYaml& yaml) {
          return take_number(value, 0.0, 1.0, yaml.occupied_thresh);
        }},
    Key{"free_thresh", "a probability from 0 to 1",
        [](std::string_view value, MapYaml& yaml) {
          return take_number(value, 0.0, 1.0, yaml.free_thresh);
        }},
    Key{"mode", "trinary or scale (raw maps cannot be read)",
        [](std::string_view value, MapYaml&) {
          const auto mode = to_text(value);
          return mode == "trinary" || mode == "scale";
        }},
};

Result<void> take_line(std::string_view line, const std::string& place, MapYaml& yaml,
                       std::set<std::string_view>& taken) {
  const std::string_view content = trimmed(without_comment(line));
  if (content.empty() || content == "---" || content == "...") return {};
  const std::size_t colon = content.find(':');
  const auto at = [&](std::string_view part) {
    return place + ':' + std::to_string(part.data() - line.data() + 1);
  };
  if (colon == std::string_view::npos)
    return Error{ErrorCode::kBadInput, "expected `key: value`", at(content)};
  const std::string_view key = trimmed(content.substr(0, colon));
  const std::string_view value = trimmed(content.substr(colon + 1));
  for (const Key& known : kKeys) {
    if (key != known.name) continue;
    if (!taken.insert(known.name).second)
      return Error{ErrorCode::kBadInput, std::string(key) + " stands here a second time", at(key)};
    if (known.take(value, yaml)) return {};
    return Error{ErrorCode::kBadInput, std::string(key) + " expects " + known.expected,
                 at(value.empty() ? key : value)};
  }
  return {};
}

}  // namespace

Result<MapYaml> read_map_yaml(std::string_view text, const std::string& name) {
  MapYaml yaml;
  std::set<std::string_view> taken;
  for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const auto done = take_line(text.substr(begin, end - begin),
                                name + ':' + std::to_string(number), yaml, taken);
    if (!done) return done.error();
    begin = end + 1;
  }
  for (const Key& key : kKeys) {
    if (std::string_view(key.name) != "mode" && !taken.contains(key.name))
      return Error{ErrorCode::kBadInput,
                   std::string("the key ") + key.name + " is missing; expected " + key.expected,
                   name};
  }
  if (yaml.free_thresh > yaml.occupied_thresh)
    return Error{ErrorCode::kBadInput, "free_thresh is above occupied_thresh; expected the reverse",
                 name};
  return yaml;
}

}  // namespace cairn
