// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/carmen/carmen_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cairn/io/input_text.hpp"
#include "frontends/carmen/carmen_line.hpp"

namespace cairn {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSickMaxRangeM = 80.0;  // 81.91 m is its "no echo"
constexpr std::size_t kMostChangesTold = 5;

// What PARAM lines tell.
struct Parameters {
  std::optional<double> resolution_deg, max_range_m;
  double ahead_m = 0.0, sideways_m = 0.0, turned_rad = 0.0;  // the laser on the robot

  void read(const Record& record) {
    const auto take = [&](std::string_view name, auto& target) {
      if (const auto value = read_parameter(record, name)) target = *value;
    };
    take("laser_front_laser_resolution", resolution_deg);
    take("robot_front_laser_max", max_range_m);
    take("robot_frontlaser_offset", ahead_m);
    take("robot_frontlaser_side_offset", sideways_m);
    take("robot_frontlaser_angular_offset", turned_rad);
  }
  [[nodiscard]] Se2 T_robot_laser() const { return {ahead_m, sideways_m, turned_rad}; }
};

struct ReadLine {
  ScanLine line;
  std::optional<Se2> T_odom_robot;  // of the last ODOM line before
};

// Reads line by line, then decides what all of them mean together.
class LogReader {
 public:
  LogReader(const std::string& name, const CarmenOptions& options) : options_(options) {
    log_.name = name;
  }

  Result<void> add(const Record& record) {
    for (std::size_t kind = 0; kind < kScanTags.size(); ++kind) {
      if (record.tag != kScanTags[kind]) continue;
      Result<ScanLine> line = read_scan_line(record, static_cast<ScanKind>(kind), log_.name);
      if (!line) return line.error();
      lines_[kind].push_back({std::move(*line), T_odom_robot_});
      return {};
    }
    if (record.tag == "PARAM") parameters_.read(record);
    if (record.tag != "ODOM") return {};
    const Result<std::optional<Se2>> T_odom_robot = read_odometry_line(record, log_.name);
    if (!T_odom_robot) return T_odom_robot.error();
    T_odom_robot_ = *T_odom_robot;
    return {};
  }

  void leave_out_cut_line(const Record& record, const Error& error) {
    log_.warnings.push_back(error.to_string() + "; the log was cut in this " +
                            std::string(record.tag) + " line, which is left out");
  }

  Result<CarmenLog> finish() {
    const auto chosen = std::find_if(lines_.begin(), lines_.end(),
                                     [](const auto& lines) { return !lines.empty(); });
    if (chosen == lines_.end()) {
      return Error{ErrorCode::kBadInput,
                   "no laser scan in it; ROBOTLASER1, FLASER or RAWLASER1 lines of a CARMEN log "
                   "are expected",
                   place_in(log_.name, 1, 1)};
    }
    const auto kind = static_cast<std::size_t>(chosen - lines_.begin());
    tell_other_kinds(kind);
    for (ReadLine& read : *chosen)
      if (Result<void> complete = complete_scan(read.line); !complete) return complete.error();
    place_scans(*chosen);
    tell_changes(*chosen);
    for (ReadLine& read : *chosen) log_.scans.push_back(std::move(read.line.scan));
    return std::move(log_);
  }

 private:
  void warn(const ScanLine& at, const std::string& message) {
    log_.warnings.push_back(place_in(log_.name, at.line, at.readings_column) + ": " + message);
  }

  void tell_other_kinds(std::size_t chosen) {
    for (std::size_t kind = chosen + 1; kind < lines_.size(); ++kind) {
      if (lines_[kind].empty()) continue;
      warn(lines_[kind].front().line, std::to_string(lines_[kind].size()) + " " +
                                          std::string(kScanTags[kind]) +
                                          " lines are left out: " + std::string(kScanTags[chosen]) +
                                          " lines are taken to hold the same scans");
    }
  }

  // FLASER lines say nothing of angles: half a circle, or what PARAM or the caller says.
  Result<void> complete_scan(ScanLine& line) {
    LaserScan& scan = line.scan;
    if (scan.angle_step_rad > 0.0) return {};
    const auto count = static_cast<double>(scan.ranges_m.size());
    scan.max_range_m = parameters_.max_range_m.value_or(kSickMaxRangeM);
    if (options_.field_of_view_rad) {
      scan.angle_step_rad = *options_.field_of_view_rad / (count - 1.0);
    } else if (count == 180.0 || count == 181.0 || count == 360.0 || count == 361.0) {
      scan.angle_step_rad = (count < 200.0 ? 1.0 : 0.5) * kDegree;
      scan.first_angle_rad = -90.0 * kDegree;
      return {};
    } else if (parameters_.resolution_deg && *parameters_.resolution_deg > 0.0 &&
               *parameters_.resolution_deg * (count - 1.0) <= 361.0) {
      scan.angle_step_rad = *parameters_.resolution_deg * kDegree;
    } else {
      return Error{ErrorCode::kBadInput,
                   "FLASER with " + std::to_string(scan.ranges_m.size()) +
                       " readings does not tell its angles: 180, 181, 360 or 361 are half a "
                       "circle; for others give the field of view, or a line 'PARAM "
                       "laser_front_laser_resolution DEGREES'",
                   place_in(log_.name, line.line, line.readings_column)};
    }
    scan.first_angle_rad = -0.5 * (count - 1.0) * scan.angle_step_rad;
    return {};
  }

  // Where odometry says the laser was: the line's first pose, unless another program has corrected
  // that, or there is none.
  void place_scans(std::vector<ReadLine>& lines) {
    const Se2 T_robot_laser = parameters_.T_robot_laser();
    if (has_no_odometry(lines)) {
      const bool from_odom =
          std::any_of(lines.begin(), lines.end(), [](const ReadLine& l) { return l.T_odom_robot; });
      for (ReadLine& read : lines) {
        read.line.scan.T_odom_laser.reset();
        if (read.T_odom_robot) read.line.scan.T_odom_laser = *read.T_odom_robot * T_robot_laser;
      }
      if (!from_odom) warn(lines.front().line, "the log has no odometry: all its poses are 0");
      return;
    }
    const bool corrected = is_corrected(lines);
    for (ReadLine& read : lines) {
      ScanLine& line = read.line;
      if (!corrected) line.scan.T_odom_laser = line.T_odom_laser;
      if (corrected && line.T_odom_robot)
        line.scan.T_odom_laser = *line.T_odom_robot * T_robot_laser;
    }
    if (corrected)
      warn(lines.front().line,
           "the laser's poses do not stay in place on the robot: another program has corrected "
           "them; odometry is taken from the robot's poses");
  }

  static bool has_no_odometry(const std::vector<ReadLine>& lines) {
    const auto nowhere = [](const std::optional<Se2>& T) {
      return !T || T->to_vector().isZero(0.0);
    };
    return std::all_of(lines.begin(), lines.end(), [&](const ReadLine& read) {
      return nowhere(read.line.T_odom_laser) && nowhere(read.line.T_odom_robot);
    });
  }

  // Whether the laser moves about on the robot, by more than rounding does. Robot poses that are
  // all 0 were not written.
  static bool is_corrected(const std::vector<ReadLine>& lines) {
    constexpr double kApartM = 0.01, kApartRad = 0.01;
    std::optional<Se2> first;
    bool moves = false, robot_written = false;
    for (const ReadLine& read : lines) {
      if (!read.line.T_odom_laser || !read.line.T_odom_robot) continue;
      robot_written = robot_written || !read.line.T_odom_robot->to_vector().isZero(0.0);
      const Se2 T_robot_laser = read.line.T_odom_robot->inverse() * *read.line.T_odom_laser;
      if (!first) first = T_robot_laser;
      const Se2 change = first->inverse() * T_robot_laser;
      moves =
          moves || change.translation().norm() > kApartM || std::abs(change.theta()) > kApartRad;
    }
    return moves && robot_written;
  }

  void tell_changes(const std::vector<ReadLine>& lines) {
    std::size_t odd = 0, lost = 0, changes = 0;
    const ScanLine *first_odd = nullptr, *first_lost = nullptr;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const ScanLine& line = lines[i].line;
      odd += line.odd_readings;
      if (line.odd_readings && !first_odd) first_odd = &line;
      const bool is_lost = i > 0 && lines[0].line.scan.T_odom_laser && !line.scan.T_odom_laser;
      lost += is_lost;
      if (is_lost && !first_lost) first_lost = &line;
      if (i == 0) continue;
      const std::size_t before = lines[i - 1].line.scan.ranges_m.size();
      const std::size_t now = line.scan.ranges_m.size();
      if (before != now && ++changes <= kMostChangesTold)
        warn(line, "from here on a scan has " + std::to_string(now) + " readings, before " +
                       std::to_string(before));
    }
    if (changes > kMostChangesTold)
      log_.warnings.push_back(log_.name + ": the number of readings changes " +
                              std::to_string(changes) + " times");
    if (odd)
      warn(*first_odd, std::to_string(odd) +
                           " readings are negative or no number, the first in this line; they are "
                           "taken as no echo");
    if (lost)
      warn(*first_lost, std::to_string(lost) +
                            " scans have an odometry that is not finite, the first in this line; "
                            "it is left out");
  }

  CarmenOptions options_;
  CarmenLog log_;
  Parameters parameters_;
  std::optional<Se2> T_odom_robot_;
  std::array<std::vector<ReadLine>, kScanTags.size()> lines_;
};

}  // namespace

Result<CarmenLog> read_carmen_text(std::string_view text, const std::string& name,
                                   const CarmenOptions& options) {
  if (const double view = options.field_of_view_rad.value_or(1.0);
      !(view > 0.0 && view <= 2.01 * std::numbers::pi))
    return Error{ErrorCode::kUsage, "a field of view above 0 and up to 360 deg is expected"};
  LogReader reader(name, options);
  RecordScanner scanner(text);
  Record record;
  while (scanner.next(record)) {
    const Result<void> added = reader.add(record);
    if (added) continue;
    const char* behind = record.line.data() + record.line.size();
    const bool is_cut =
        text.find('\n', static_cast<std::size_t>(behind - text.data())) == std::string_view::npos;
    if (!is_cut) return added.error();
    reader.leave_out_cut_line(record, added.error());
  }
  return reader.finish();
}

Result<CarmenLog> read_carmen_log(const std::string& path, const CarmenOptions& options) {
  const Result<InputText> text = read_input_text(path);
  if (!text) return text.error();
  return read_carmen_text(text->view, input_name(path), options);
}

}  // namespace cairn
