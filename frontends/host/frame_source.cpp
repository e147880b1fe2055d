// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/frame_source.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>
#include <vector>

#include "frontends/carmen/carmen_log.hpp"
#include "frontends/ros/ros_robot.hpp"
#include "frontends/simulated/simulated_drive.hpp"

namespace cairn {
namespace {

class ScanSource final : public FrameSource {
 public:
  explicit ScanSource(std::vector<LaserScan> scans) : scans_(std::move(scans)) {}
  Result<NextFrame> next() override {
    if (next_ == scans_.size()) return NextFrame(EndOfInput());
    return NextFrame(SensorFrame(std::move(scans_[next_++])));
  }

 private:
  std::vector<LaserScan> scans_;
  std::size_t next_ = 0;
};

Result<std::unique_ptr<FrameSource>> open_simulation(const std::string& seed) {
  DriveOptions options;
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), options.seed);
  if (!seed.empty() && (error != std::errc() || end != seed.data() + seed.size()))
    return Error{ErrorCode::kUsage, "the seed '" + seed.substr(0, 40) +
                                        "' of the simulation is no whole number; expected "
                                        "simulated or simulated:SEED"};
  return std::unique_ptr<FrameSource>(std::make_unique<ScanSource>(simulate_drive(options).scans));
}

Result<std::unique_ptr<FrameSource>> open_log(const std::string& path) {
  Result<CarmenLog> log = read_carmen_log(path);
  if (!log) return log.error();
  for (const std::string& warning : log->warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  return std::unique_ptr<FrameSource>(std::make_unique<ScanSource>(std::move(log->scans)));
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_input(const std::string& name, std::uint32_t domain) {
  const std::string simulated = "simulated";
  if (name == simulated) return open_simulation("");
  if (name.starts_with(simulated + ":")) return open_simulation(name.substr(simulated.size() + 1));
  if (name == "ros" || name.starts_with("ros:"))
    return open_ros_robot(name.substr(std::min<std::size_t>(name.size(), 4)), domain);
  return open_log(name);
}

}  // namespace cairn
