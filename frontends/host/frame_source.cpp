// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/frame_source.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>
#include <vector>

#include "frontends/carmen/carmen_log.hpp"
#include "frontends/host/tum.hpp"
#include "frontends/ros/ros_robot.hpp"
#include "frontends/simulated/simulated_drive.hpp"

namespace cairn {
namespace {

class ScanSource final : public FrameSource {
 public:
  explicit ScanSource(std::vector<LaserScan> scans, std::string truth = {})
      : scans_(std::move(scans)), truth_(std::move(truth)) {}
  Result<NextFrame> next() override {
    if (next_ == scans_.size()) return NextFrame(EndOfInput());
    return NextFrame(SensorFrame(std::move(scans_[next_++])));
  }

  [[nodiscard]] std::string truth() const override { return truth_; }

 private:
  std::vector<LaserScan> scans_;
  std::string truth_;
  std::size_t next_ = 0;
};

class WithoutOdometry final : public FrameSource {
 public:
  explicit WithoutOdometry(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  Result<NextFrame> next() override {
    Result<NextFrame> next = source_->next();
    if (!next) return next;
    if (auto* frame = std::get_if<SensorFrame>(&*next))
      std::get<LaserScan>(*frame).T_odom_laser.reset();
    return next;
  }
  [[nodiscard]] bool is_live() const override { return source_->is_live(); }
  [[nodiscard]] HostObserver* observer() override { return source_->observer(); }
  [[nodiscard]] std::string truth() const override { return source_->truth(); }
  [[nodiscard]] std::string report() const override { return source_->report(); }

 private:
  std::unique_ptr<FrameSource> source_;
};

Result<std::unique_ptr<FrameSource>> open_simulation(const std::string& seed) {
  DriveOptions options;
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), options.seed);
  if (!seed.empty() && (error != std::errc() || end != seed.data() + seed.size()))
    return Error{ErrorCode::kUsage, "the seed '" + seed.substr(0, 40) +
                                        "' of the simulation is no whole number; expected "
                                        "simulated or simulated:SEED"};
  SimulatedDrive drive = simulate_drive(options);
  std::string truth = kTumHeader;
  for (std::size_t i = 0; i < drive.scans.size(); ++i)
    truth += tum_line(drive.scans[i].stamp_ns, drive.truth[i]);
  return std::unique_ptr<FrameSource>(
      std::make_unique<ScanSource>(std::move(drive.scans), std::move(truth)));
}

Result<std::unique_ptr<FrameSource>> open_log(const std::string& path) {
  Result<CarmenLog> log = read_carmen_log(path);
  if (!log) return log.error();
  for (const std::string& warning : log->warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  return std::unique_ptr<FrameSource>(std::make_unique<ScanSource>(std::move(log->scans)));
}

}  // namespace

std::unique_ptr<FrameSource> without_odometry(std::unique_ptr<FrameSource> source) {
  return std::make_unique<WithoutOdometry>(std::move(source));
}

Result<std::unique_ptr<FrameSource>> open_input(const std::string& name, std::uint32_t domain) {
  const std::string simulated = "simulated";
  if (name == simulated) return open_simulation("");
  if (name.starts_with(simulated + ":")) return open_simulation(name.substr(simulated.size() + 1));
  if (name == "ros" || name.starts_with("ros:"))
    return open_ros_robot(name.substr(std::min<std::size_t>(name.size(), 4)), domain);
  return open_log(name);
}

}  // namespace cairn
