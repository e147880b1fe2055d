// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/carmen/carmen_line.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "cairn/io/decimal.hpp"
#include "cairn/io/number_line.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMostReadings = 100'000;
constexpr double kFarthestM = 1e6;  // beyond it lies nothing
constexpr std::size_t kPoses = 6, kVelocities = 5;
constexpr std::size_t kEnd = 3;  // stamp, host, logger's stamp

// One line from left to right: the first fault stays, and nothing is read after it.
class LineReader {
 public:
  LineReader(const Record& record, std::string_view file)
      : record_(record), file_(file), cursor_(record) {}

  /// Finite.
  double number(const char* what) {
    const Field field = next(what);
    double value = 0.0;
    if (!fault_) {
      const NumberFault fault = parse_number(field.text, value);
      if (fault != NumberFault::kNone)
        fail(field.column, describe_number_fault(fault, field.text) + "; expected " + what);
    }
    return value;
  }
  /// NaN where it is written so, and infinity.
  double any_number(const char* what) {
    const Field field = next(what);
    double value = 0.0;
    if (fault_) return value;
    const char* end = field.text.data() + field.text.size();
    if (take_decimal(field.text.data(), end, value) == end) return value;
    const NumberFault fault = parse_number(field.text, value);
    if (fault == NumberFault::kNone) return value;
    if (fault == NumberFault::kNotFinite)
      return field.text.find_first_of("iI") == std::string_view::npos
                 ? std::numeric_limits<double>::quiet_NaN()
                 : std::numeric_limits<double>::infinity();
    fail(field.column, describe_number_fault(fault, field.text) + "; expected " + what);
    return value;
  }
  std::size_t count(const char* what, std::size_t least) {
    const Field field = next(what);
    std::uint64_t value = 0;
    if (!fault_ && (parse_id(field.text, value) != NumberFault::kNone || value < least ||
                    value > kMostReadings))
      fail(field.column, "'" + quote(field.text) + "' is no " + what + ": a whole number from " +
                             std::to_string(least) + " to " + std::to_string(kMostReadings) +
                             " is expected");
    return fault_ ? 0 : static_cast<std::size_t>(value);
  }
  std::int64_t stamp() {
    const Field field = next("the time stamp");
    if (fault_) return 0;
    const Result<std::uint64_t> stamp = stamp_in(field, record_, file_);
    if (!stamp) fault_ = stamp.error();
    return stamp ? static_cast<std::int64_t>(*stamp) : 0;
  }
  std::optional<Se2> pose(const char* what) {
    const double x = any_number(what), y = any_number(what), theta = any_number(what);
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(theta)) return std::nullopt;
    return Se2(x, y, theta);
  }
  /// `expected` fields behind the tag, or one less: some logs lack the logger's stamp.
  void require_fields(std::size_t expected, std::size_t readings) {
    const std::size_t found = count_fields(record_);
    if (fault_ || found == expected || found + 1 == expected) return;
    fail(1, quote(record_.tag) + " with " + std::to_string(readings) + " readings expects " +
                std::to_string(expected) + " fields, found " + std::to_string(found));
  }
  void require(bool sound, const std::string& message) {
    if (!fault_ && !sound) fail(field_.column, message);
  }

  [[nodiscard]] std::size_t column() const { return field_.column; }
  [[nodiscard]] const std::optional<Error>& fault() const { return fault_; }

 private:
  Field next(const char* what) {
    if (fault_) return field_;
    if (const auto field = cursor_.next()) return field_ = *field;
    fail(record_.line.size() + 1, std::string("the line ends; expected ") + what);
    return field_;
  }
  void fail(std::size_t column, std::string message) {
    fault_ = error_at(record_, file_, column, std::move(message));
  }

  const Record& record_;
  std::string_view file_;
  FieldCursor cursor_;
  Field field_;
  std::optional<Error> fault_;
};

void read_readings(LineReader& line, std::size_t count, ScanLine& result) {
  result.scan.ranges_m.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double range = line.any_number("a reading");
    if (i == 0) result.readings_column = line.column();
    result.odd_readings += std::isnan(range) || range < 0.0;
    result.scan.ranges_m.push_back(std::abs(range) > kFarthestM
                                       ? std::numeric_limits<float>::infinity()
                                       : static_cast<float>(range));
  }
}

void read_poses(LineReader& line, ScanLine& result) {
  result.T_odom_laser = line.pose("the laser's pose");
  result.T_odom_robot = line.pose("the robot's pose");
}

// FLASER n r1 .. rn  laser's pose  robot's pose  stamp host logger's stamp
void read_flaser(LineReader& line, ScanLine& result) {
  const std::size_t count = line.count("number of readings", 2);
  line.require_fields(1 + count + kPoses + kEnd, count);
  if (line.fault()) return;
  read_readings(line, count, result);
  read_poses(line, result);
  result.scan.stamp_ns = line.stamp();
}

// type first_angle field_of_view resolution max_range accuracy remission_mode n r1 .. rn m e1 .. em
// and, of ROBOTLASER1: laser's pose  robot's pose  tv rv forward side turn; stamp host logger's
// stamp
void read_robotlaser(LineReader& line, bool with_poses, ScanLine& result) {
  LaserScan& scan = result.scan;
  line.number("the laser's type");
  scan.first_angle_rad = line.number("the first angle");
  line.require(std::abs(scan.first_angle_rad) <= 2.0 * std::numbers::pi,
               "the first angle must be within a turn, in rad");
  line.number("the field of view");
  scan.angle_step_rad = line.number("the angular resolution");
  line.require(scan.angle_step_rad > 0.0, "the angular resolution must be above 0");
  scan.max_range_m = line.number("the largest range");
  line.require(scan.max_range_m > 0.0, "the largest range must be above 0");
  line.number("the accuracy");
  line.number("the remission mode");
  const std::size_t count = line.count("number of readings", 1);
  line.require(static_cast<double>(count - 1) * scan.angle_step_rad <= 2.01 * std::numbers::pi,
               "so many readings at this angular resolution are more than a turn");
  if (line.fault()) return;
  read_readings(line, count, result);
  const std::size_t remissions = line.count("number of remissions", 0);
  line.require_fields(9 + count + remissions + (with_poses ? kPoses + kVelocities : 0) + kEnd,
                      count);
  if (line.fault()) return;
  for (std::size_t i = 0; i < remissions; ++i) line.any_number("a remission");
  if (with_poses) {
    read_poses(line, result);
    for (std::size_t i = 0; i < kVelocities; ++i) line.any_number("a velocity or distance");
  }
  scan.stamp_ns = line.stamp();
}

}  // namespace

Result<ScanLine> read_scan_line(const Record& record, ScanKind kind, std::string_view file) {
  LineReader line(record, file);
  ScanLine result{.line = record.line_number};
  if (kind == ScanKind::kFlaser) {
    read_flaser(line, result);
  } else {
    read_robotlaser(line, kind == ScanKind::kRobotLaser, result);
  }
  if (line.fault()) return *line.fault();
  return result;
}

Result<std::optional<Se2>> read_odometry_line(const Record& record, std::string_view file) {
  LineReader line(record, file);
  const std::optional<Se2> pose = line.pose("the robot's pose");
  if (line.fault()) return *line.fault();
  return pose;
}

std::optional<double> read_parameter(const Record& record, std::string_view name) {
  const auto found = field_at(record, 0), value = field_at(record, 1);
  if (!found || !value || found->text != name) return std::nullopt;
  double number;
  if (parse_number(value->text, number) != NumberFault::kNone) return std::nullopt;
  return number;
}

}  // namespace cairn
