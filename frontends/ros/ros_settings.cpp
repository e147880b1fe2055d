// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/ros_settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "cairn/io/record_scanner.hpp"
#include "idl/dds/ros_topics.hpp"

namespace cairn {
namespace {

struct Key {
  std::string_view name, expected;
  std::function<bool(const std::string&, RosSettings&)> read;
};

std::optional<int> whole_number(const std::string& text, int most) {
  int number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || number < 0 || number > most) return std::nullopt;
  return number;
}

Key topic(std::string_view name, std::string RosSettings::*where, bool may_be_absent) {
  return {name,
          may_be_absent ? "a topic such as /name, or nothing for none" : "a topic such as /name",
          [=](const std::string& text, RosSettings& settings) {
            if (text.empty() && may_be_absent) return (settings.*where).clear(), true;
            const Result<std::string> known = ros::topic_name(text);
            if (known) settings.*where = *known;
            return known.ok();
          }};
}

Key frame(std::string_view name, std::string RosSettings::*where) {
  return {name, "a frame such as map", [=](const std::string& text, RosSettings& settings) {
            settings.*where = text;
            return !text.empty() && text.size() <= 100 &&
                   std::all_of(text.begin(), text.end(),
                               [](unsigned char c) { return c > 32 && c < 127; });
          }};
}

// "0.2/0/90": x m, y m, yaw deg.
bool read_mount(const std::string& text, RosSettings& settings) {
  std::array<double, 3> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != '/')) return false;
    const auto [stop, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc() || !(std::abs(numbers[i]) <= 1000.0)) return false;
    at = stop;
  }
  settings.T_base_laser = Se2(numbers[0], numbers[1], numbers[2] * std::numbers::pi / 180.0);
  return at == end;
}

const std::vector<Key>& keys() {
  static const std::vector<Key> kAll{
      {"domain", "a number from 0 to 230",
       [](const std::string& text, RosSettings& settings) {
         const auto number = whole_number(text, 230);
         settings.domain = static_cast<std::uint32_t>(number.value_or(0));
         return number.has_value();
       }},
      {"interface", "a network interface such as eth0",
       [](const std::string& text, RosSettings& settings) {
         settings.network.interface = text;
         return !text.empty();
       }},
      topic("scan", &RosSettings::scan, false),
      topic("odom", &RosSettings::odometry, true),
      topic("tf", &RosSettings::tf, true),
      topic("tf_static", &RosSettings::tf_static, true),
      topic("trajectory", &RosSettings::trajectory, true),
      frame("map_frame", &RosSettings::map_frame),
      frame("odom_frame", &RosSettings::odom_frame),
      {"laser", "where the laser is on the robot: X/Y/YAW in m and deg, such as 0.2/0/180",
       read_mount},
      {"tf_ahead_ms", "milliseconds up to 10000",
       [](const std::string& text, RosSettings& settings) {
         const auto number = whole_number(text, 10'000);
         settings.tf_ahead = std::chrono::milliseconds(number.value_or(0));
         return number.has_value();
       }},
  };
  return kAll;
}

Result<void> read_setting(const std::string& text, RosSettings& settings) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const auto key =
      std::find_if(keys().begin(), keys().end(), [&](const Key& k) { return k.name == name; });
  if (equals == std::string::npos || key == keys().end()) {
    std::string names;
    for (const Key& known : keys()) names += (names.empty() ? "" : ", ") + std::string(known.name);
    return Error{ErrorCode::kUsage, "--input ros: '" + quote(text) +
                                        "' is no setting; expected KEY=VALUE with one of " + names};
  }
  const std::string value = text.substr(equals + 1);
  if (key->read(value, settings)) return {};
  return Error{ErrorCode::kUsage, "--input ros: " + name + " is '" + quote(value) + "'; expected " +
                                      std::string(key->expected)};
}

}  // namespace

Result<RosSettings> parse_ros_settings(const std::string& text) {
  RosSettings settings;
  const Result<std::uint32_t> domain = ros::domain_of_environment();
  if (!domain) return domain.error();
  settings.domain = *domain;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (auto read = read_setting(text.substr(begin, end - begin), settings); !read)
      return read.error();
    begin = end + 1;
  }
  return settings;
}

}  // namespace cairn
