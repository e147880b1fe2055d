// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/carmen/carmen_log.hpp"

#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "cairn/io/input_text.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMostBeams = 100'000;

// One line: words and numbers from left to right, with their columns.
class Line {
 public:
  Line(std::string_view text, std::string_view file, std::size_t number)
      : text_(text), file_(file), number_(number) {}

  std::string_view word() {
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < text_.size() && text_[at_] != ' ' && text_[at_] != '\t' && text_[at_] != '\r')
      ++at_;
    last_ = first;
    return text_.substr(first, at_ - first);
  }
  /// False, and fault() says why, where there is none.
  bool number(double& value, const char* what) {
    const std::string_view text = word();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size()) return true;
    fail(text.empty() ? "the line ends; expected " + std::string(what)
                      : "'" + std::string(text.substr(0, 40)) + "' is no number; expected " + what);
    return false;
  }
  bool count(std::size_t& value, const char* what) {
    double number_read = 0.0;
    if (!number(number_read, what)) return false;
    if (number_read >= 0.0 && number_read <= kMostBeams && number_read == std::floor(number_read)) {
      value = static_cast<std::size_t>(number_read);
      return true;
    }
    fail(std::string(what) + " must be a whole number up to " + std::to_string(kMostBeams));
    return false;
  }
  void fail(std::string message) {
    fault_ =
        Error{ErrorCode::kBadInput, std::move(message),
              std::string(file_) + ':' + std::to_string(number_) + ':' + std::to_string(last_ + 1)};
  }
  [[nodiscard]] const Error& fault() const { return fault_; }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r'))
      ++at_;
  }

  std::string_view text_, file_;
  std::size_t number_, at_ = 0, last_ = 0;
  Error fault_{ErrorCode::kBadInput, ""};
};

bool read_pose(Line& line, Se2& T, const char* what) {
  double x = 0.0, y = 0.0, theta = 0.0;
  if (!line.number(x, what) || !line.number(y, what) || !line.number(theta, what)) return false;
  T = Se2(x, y, theta);
  return true;
}

bool read_ranges(Line& line, std::size_t count, LaserScan& scan) {
  scan.ranges_m.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    double range = 0.0;
    if (!line.number(range, "a reading")) return false;
    scan.ranges_m.push_back(static_cast<float>(range));
  }
  return true;
}

bool read_stamp(Line& line, std::int64_t& stamp_ns) {
  double seconds = 0.0;
  if (!line.number(seconds, "the time stamp in seconds")) return false;
  if (!(std::abs(seconds) < 9e9)) {
    line.fail("the time stamp is out of range");
    return false;
  }
  stamp_ns = std::llround(seconds * 1e9);
  return true;
}

// FLASER n r1 .. rn  x y theta  odom_x odom_y odom_theta  ipc_stamp host logger_stamp
bool read_flaser(Line& line, LaserScan& scan) {
  std::size_t count = 0;
  if (!line.count(count, "the number of readings")) return false;
  scan.angle_step_rad = count > 181 ? 0.5 * std::numbers::pi / 180.0 : std::numbers::pi / 180.0;
  scan.first_angle_rad = -0.5 * std::numbers::pi;
  scan.max_range_m = 80.0;
  Se2 T_odom_laser, T_odom_robot;
  if (!read_ranges(line, count, scan) || !read_pose(line, T_odom_laser, "the laser's pose") ||
      !read_pose(line, T_odom_robot, "the robot's pose") || !read_stamp(line, scan.stamp_ns))
    return false;
  scan.T_odom_laser = T_odom_laser;
  return true;
}

// ROBOTLASER1 type first_angle field_of_view step max_range accuracy remission_mode
//   n r1 .. rn  m e1 .. em  laser pose  robot pose  tv rv forward side turn  stamp host stamp
bool read_robotlaser(Line& line, LaserScan& scan) {
  double type = 0.0, field = 0.0, accuracy = 0.0, mode = 0.0;
  std::size_t count = 0, remissions = 0;
  if (!line.number(type, "the laser's type") ||
      !line.number(scan.first_angle_rad, "the first angle") ||
      !line.number(field, "the field of view") ||
      !line.number(scan.angle_step_rad, "the angular resolution") ||
      !line.number(scan.max_range_m, "the largest range") ||
      !line.number(accuracy, "the accuracy") || !line.number(mode, "the remission mode") ||
      !line.count(count, "the number of readings") || !read_ranges(line, count, scan) ||
      !line.count(remissions, "the number of remissions"))
    return false;
  double ignored = 0.0;
  for (std::size_t i = 0; i < remissions; ++i)
    if (!line.number(ignored, "a remission")) return false;
  Se2 T_odom_laser, T_odom_robot;
  if (!read_pose(line, T_odom_laser, "the laser's pose") ||
      !read_pose(line, T_odom_robot, "the robot's pose"))
    return false;
  for (int i = 0; i < 5; ++i)
    if (!line.number(ignored, "velocities and distances")) return false;
  if (!read_stamp(line, scan.stamp_ns)) return false;
  scan.T_odom_laser = T_odom_laser;
  return true;
}

}  // namespace

Result<void> read_carmen_log(const std::string& path,
                             const std::function<void(LaserScan&&)>& on_scan) {
  const Result<InputText> text = read_input_text(path);
  if (!text) return text.error();
  const std::string name = input_name(path);
  std::size_t number = 0;
  for (std::string_view rest = text->view; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    Line line(rest.substr(0, end), name, ++number);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::string_view tag = line.word();
    LaserScan scan;
    if (tag == "FLASER") {
      if (!read_flaser(line, scan)) return line.fault();
    } else if (tag == "ROBOTLASER1") {
      if (!read_robotlaser(line, scan)) return line.fault();
    } else {
      continue;
    }
    on_scan(std::move(scan));
  }
  return {};
}

}  // namespace cairn
