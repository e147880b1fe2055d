// SPDX-License-Identifier: BSD-3-Clause
#include "server/config.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <concepts>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "cairn/io/input_text.hpp"

namespace cairn {
namespace {

// One key: how it is read and shown stand side by side, so that nothing is undocumented.
struct Setting {
  std::string section, key;
  std::string meaning;
  std::string expected;  ///< the values it takes
  std::function<bool(const std::string&, DaemonConfig&)> read;
  std::function<std::string(const DaemonConfig&)> show;
};

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::istringstream stream(text);
  std::int64_t number = 0;
  if (!(stream >> number) || !stream.eof()) return std::nullopt;
  return number;
}

template <std::integral Number>
std::int64_t count_of(Number number) {
  return static_cast<std::int64_t>(number);
}
std::int64_t count_of(std::chrono::milliseconds time) { return time.count(); }

struct Range {
  std::int64_t first, last;
};

// A number with a fraction, such as 0.05.
template <class Of>
Setting decimal(std::string section, std::string key, std::string meaning, double first,
                double last, Of of) {
  const auto show = [](double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  };
  return {std::move(section),
          std::move(key),
          std::move(meaning),
          "a number from " + show(first) + " to " + show(last),
          [=](const std::string& text, DaemonConfig& config) {
            std::istringstream stream(text);
            double value = 0.0;
            if (!(stream >> value) || !stream.eof() || !(value >= first && value <= last))
              return false;
            of(config) = value;
            return true;
          },
          [=](const DaemonConfig& config) { return show(of(config)); }};
}

// `of` gives a reference to the number in a configuration; `unit` of the file in units of that
// number.
template <class Of>
Setting number(std::string section, std::string key, std::string meaning, Range range, Of of,
               std::int64_t unit = 1) {
  using Number = std::decay_t<decltype(of(std::declval<DaemonConfig&>()))>;
  return {
      std::move(section),
      std::move(key),
      std::move(meaning),
      "a whole number from " + std::to_string(range.first) + " to " + std::to_string(range.last),
      [range, of, unit](const std::string& text, DaemonConfig& config) {
        const auto value = whole_number(text);
        if (!value || *value < range.first || *value > range.last) return false;
        of(config) = Number(*value * unit);
        return true;
      },
      [of, unit](const DaemonConfig& config) {
        return std::to_string(count_of(of(config)) / unit);
      }};
}

template <class Enum, class Of>
Setting choice(std::string section, std::string key, std::string meaning,
               std::vector<std::pair<std::string, Enum>> names, Of of) {
  std::string expected;
  for (const auto& [name, value] : names) expected += (expected.empty() ? "" : ", ") + name;
  return {std::move(section),
          std::move(key),
          std::move(meaning),
          "one of " + expected,
          [names, of](const std::string& text, DaemonConfig& config) {
            for (const auto& [name, value] : names) {
              if (name == text) return of(config) = value, true;
            }
            return false;
          },
          [names, of](const DaemonConfig& config) {
            const Enum value = of(config);
            return std::find_if(names.begin(), names.end(),
                                [&](const auto& named) { return named.second == value; })
                ->first;
          }};
}

template <class Of>
Setting text(std::string section, std::string key, std::string meaning, std::size_t longest,
             Of of) {
  return {std::move(section),
          std::move(key),
          std::move(meaning),
          "a text of at most " + std::to_string(longest) + " bytes",
          [longest, of](const std::string& value, DaemonConfig& config) {
            if (value.size() > longest) return false;
            of(config) = value;
            return true;
          },
          [of](const DaemonConfig& config) {
            YAML::Emitter quoted;
            quoted << YAML::DoubleQuoted << of(config);
            return std::string(quoted.c_str());
          }};
}

const std::vector<Setting>& settings() {
  constexpr std::int64_t kSecond = 1'000'000'000;  // of nanoseconds
  constexpr std::int64_t kDay = 86'400'000;        // of milliseconds
  constexpr std::int64_t kKilobyte = 1 << 10, kMegabyte = 1 << 20;
  static const std::vector<Setting> all{
      number("network", "domain", "DDS domain; --domain overrides it", {0, 232},
             [](auto& c) -> auto& { return c.domain; }),
      choice<dds::Profile>("network", "profile",
                           "local: datagrams of 64 kB; radio: of 1400 bytes, and what is lost is "
                           "asked for at once. Where CYCLONEDDS_URI is set, that holds",
                           {{"local", dds::Profile::kLocal}, {"radio", dds::Profile::kRadio}},
                           [](auto& c) -> auto& { return c.network.profile; }),
      text("network", "interface",
           "the network interface, such as eth0; empty: loopback, this machine only (radio: the "
           "machine's first)",
           64, [](auto& c) -> auto& { return c.network.interface; }),
      number("solve", "after_pause_ms", "the map is settled when nothing has come for so long",
             {1, 3'600'000}, [](auto& c) -> auto& { return c.service.solve_after_pause; }),
      number("solve", "every_ms",
             "what closes a loop is solved at once, but at most so often; each time the poses that "
             "moved go into the journal",
             {0, 3'600'000}, [](auto& c) -> auto& { return c.service.solve_every; }),
      number("solve", "work_limit",
             "billions of multiplications (about so many seconds) that such a solve may take; one "
             "that "
             "needs more is left, and the map is settled at once instead",
             {1, 1'000'000}, [](auto& c) -> auto& { return c.service.solve_work; }),
      number("solve", "loops_that_merge",
             "so many loop closures, at distinct places and without contradiction, tie the maps of "
             "two "
             "robots, or of two odometry epochs, into one",
             {1, 1000}, [](auto& c) -> auto& { return c.service.loops_that_merge; }),
      number("solve", "publish_every_ms",
             "poses that came are published together, at most so often", {0, 10'000},
             [](auto& c) -> auto& { return c.service.publish_every; }),
      number(
          "thin", "after_visits",
          "old poses are marginalized out of the map where so many newer ones of other visits are "
          "near, and what that loses is told; 0: never",
          {0, 1000}, [](auto& c) -> auto& { return c.service.thin_after_visits; }),
      number("thin", "radius_cm", "so near", {1, 100'000},
             [](auto& c) -> auto& { return c.service.thin_radius_cm; }),
      number("thin", "angle_deg", "and in such a direction", {1, 180},
             [](auto& c) -> auto& { return c.service.thin_angle_deg; }),
      number("jumps", "tell_cm",
             "a correction that moves a robot by more raises an event before it is published",
             {1, 1'000'000}, [](auto& c) -> auto& { return c.service.jump_cm; }),
      number("jumps", "tell_deg", "the same for its heading", {1, 180},
             [](auto& c) -> auto& { return c.service.jump_deg; }),
      number(
          "journal", "snapshot_every",
          "estimates are stored after so many records, so that a start need not apply all solves",
          {1, 1'000'000'000}, [](auto& c) -> auto& { return c.service.snapshot_every; }),
      number(
          "journal", "buffer_kb",
          "records stay in memory until there are so many KB of them; for a while twice as much",
          {64, 1'048'576}, [](auto& c) -> auto& { return c.journal_buffer_bytes; }, kKilobyte),
      number("intake", "held",
             "transactions of all sources that may wait for an earlier one or for another source",
             {1, 1'000'000}, [](auto& c) -> auto& { return c.service.limits.held; }),
      number(
          "intake", "patience_s", "how long one waits for a node of another source", {1, 86'400},
          [](auto& c) -> auto& { return c.service.limits.patience_ns; }, kSecond),
      number("intake", "kept_decisions",
             "answers kept per source for repetitions; older sequences are stale", {256, 1'000'000},
             [](auto& c) -> auto& { return c.service.limits.kept_decisions; }),
      number(
          "payloads", "keep_unnamed_days",
          "scans and images that no transaction has named are deleted after so long", {1, 36'500},
          [](auto& c) -> auto& { return c.service.payloads.keep_unnamed; }, kDay),
      choice<bool>("maps", "enabled",
                   "occupancy maps are rendered from scans and kept up to date; false: none",
                   {{"true", true}, {"false", false}},
                   [](auto& c) -> auto& { return c.service.maps.enabled; }),
      decimal("maps", "resolution_m", "side of a cell, m", 0.01, 10.0,
              [](auto& c) -> auto& { return c.service.maps.resolution_m; }),
      number("maps", "render_every_ms", "from the end of one rendering to the next",
             {10, 3'600'000}, [](auto& c) -> auto& { return c.service.maps.render_every; }),
      number(
          "maps", "most_mb",
          "memory for counts of cells, 32 kB for each 64 x 64 cells; where that is full, what is "
          "new "
          "is not rendered, and an event says so",
          {16, 1024 * 1024}, [](auto& c) -> auto& { return c.service.maps.most_bytes; }, kMegabyte),
      text("ros", "map",
           "the ROS 2 topic of the map (nav_msgs/OccupancyGrid, latest kept), such as /map; empty: "
           "none. Needs maps: enabled",
           200, [](auto& c) -> auto& { return c.ros.map; }),
      text("ros", "map_updates", "and of its changes (map_msgs/OccupancyGridUpdate)", 200,
           [](auto& c) -> auto& { return c.ros.updates; }),
      text("ros", "frame", "the frame_id of both", 100,
           [](auto& c) -> auto& { return c.ros.frame; }),
      number("ros", "domain", "the robots' ROS_DOMAIN_ID, on the interface of network", {0, 230},
             [](auto& c) -> auto& { return c.ros.domain; }),
      choice<LogFormat>("log", "format", "text: lines for people; json: one object per line",
                        {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
                        [](auto& c) -> auto& { return c.log_format; }),
      choice<Severity>(
          "log", "from", "the least severe lines that are written",
          {{"info", Severity::kInfo}, {"warning", Severity::kWarning}, {"error", Severity::kError}},
          [](auto& c) -> auto& { return c.log_from; }),
  };
  return all;
}

std::string names_of(const std::string& section) {
  std::string names;
  for (const Setting& setting : settings()) {
    const std::string& name = section.empty() ? setting.section : setting.key;
    if (!section.empty() && setting.section != section) continue;
    if (names.ends_with(name)) continue;  // sections stand together
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

Error error_at(const std::string& file, const YAML::Mark& mark, std::string message) {
  std::string place = file;
  if (!mark.is_null())
    place += ':' + std::to_string(mark.line + 1) + ':' + std::to_string(mark.column + 1);
  return {ErrorCode::kBadInput, std::move(message), std::move(place)};
}

Result<void> read_value(const std::string& file, const Setting& setting, const YAML::Node& value,
                        DaemonConfig& config) {
  if (value.IsScalar() && setting.read(value.Scalar(), config)) return {};
  const std::string found = value.IsScalar() ? "'" + value.Scalar() + "'" : "a structure";
  return error_at(
      file, value.Mark(),
      setting.section + '.' + setting.key + " is " + found + "; expected " + setting.expected);
}

Result<void> read_section(const std::string& file, const std::string& section,
                          const YAML::Node& keys, DaemonConfig& config) {
  if (!keys.IsMap()) {
    return error_at(file, keys.Mark(),
                    "the section " + section + " has no keys; expected: " + names_of(section));
  }
  std::vector<std::string> seen;
  for (const auto& entry : keys) {
    const std::string key = entry.first.as<std::string>("");
    const auto setting = std::find_if(settings().begin(), settings().end(), [&](const Setting& s) {
      return s.section == section && s.key == key;
    });
    if (setting == settings().end()) {
      return error_at(file, entry.first.Mark(),
                      "unknown key '" + section + '.' + key + "'; expected: " + names_of(section));
    }
    if (std::find(seen.begin(), seen.end(), key) != seen.end())
      return error_at(file, entry.first.Mark(), section + '.' + key + " is given twice");
    seen.push_back(key);
    if (auto read = read_value(file, *setting, entry.second, config); !read) return read;
  }
  return {};
}

Result<void> read_root(const std::string& file, const YAML::Node& root, DaemonConfig& config) {
  if (root.IsNull()) return {};  // an empty file
  if (!root.IsMap()) return error_at(file, root.Mark(), "no sections; expected: " + names_of(""));
  for (const auto& entry : root) {
    const std::string section = entry.first.as<std::string>("");
    const bool known = std::any_of(settings().begin(), settings().end(),
                                   [&](const Setting& s) { return s.section == section; });
    if (!known) {
      return error_at(file, entry.first.Mark(),
                      "unknown section '" + section + "'; expected: " + names_of(""));
    }
    if (auto read = read_section(file, section, entry.second, config); !read) return read;
  }
  return {};
}

}  // namespace

Result<void> read_config_text(const std::string& text, const std::string& name,
                              DaemonConfig& config) {
  DaemonConfig read = config;
  try {
    if (auto done = read_root(name, YAML::Load(text), read); !done) return done;
  } catch (const YAML::Exception& error) {
    return error_at(name, error.mark, "not YAML: " + error.msg);
  }
  config = std::move(read);
  return {};
}

Result<void> read_config(const std::string& path, DaemonConfig& config) {
  const Result<InputText> text = read_input_text(path);
  if (!text) return text.error();
  return read_config_text(std::string(text->view), path, config);
}

std::string dump_config(const DaemonConfig& config) {
  std::string text = "# cairnd's configuration: every key, its meaning, its value.\n";
  std::string section;
  for (const Setting& setting : settings()) {
    if (setting.section != section) text += "\n" + (section = setting.section) + ":\n";
    text += "  # " + setting.meaning + " (" + setting.expected + ")\n";
    text += "  " + setting.key + ": " + setting.show(config) + "\n";
  }
  return text;
}

}  // namespace cairn
