// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/ros_robot.hpp"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <thread>
#include <utility>

#include "cairn/io/record_scanner.hpp"
#include "frontends/ros/complaints.hpp"
#include "frontends/ros/ros_output.hpp"
#include "frontends/ros/scan_queue.hpp"
#include "frontends/ros/static_transforms.hpp"

namespace cairn {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kTurn = std::chrono::milliseconds(100);
constexpr auto kSilence = std::chrono::seconds(10);
constexpr double kMostTiltRad = 0.1;
constexpr auto kMountPatience = std::chrono::seconds(5);

std::string text_of(const char* text) { return text == nullptr ? std::string() : text; }

class RosRobot final : public FrameSource {
 public:
  explicit RosRobot(const RosSettings& settings)
      : settings_(settings), queue_(!settings.odometry.empty()) {}
  ~RosRobot() override {
    if (!thread_.joinable()) return;
    loop_->stop();
    thread_.join();
  }

  Result<void> start();

  Result<NextFrame> next() override;
  [[nodiscard]] bool is_live() const override { return true; }
  [[nodiscard]] HostObserver* observer() override { return &*output_; }
  [[nodiscard]] std::string report() const override;

 private:
  int take_scans();
  int take_odometry();
  int take_static();
  void take(const ros::LaserScan& message);
  [[nodiscard]] bool find_mount(const std::string& laser);
  template <class T>
  Result<void> listen(std::optional<dds::Reader<T>>& reader, const std::string& topic,
                      dds::Traffic traffic, int (RosRobot::*taker)());
  void complain(const char* kind, const std::string& topic, const std::string& text) {
    complaints_.add(kind,
                    topic + " in ROS domain " + std::to_string(settings_.domain) + ": " + text);
  }
  void tell_changes(const ros::LaserScan& message);
  void tell_silence();
  void tell_missing_odometry(const LaserScan& scan);

  RosSettings settings_;
  ScanQueue queue_;
  Complaints complaints_{
      [](const std::string& text) { std::fprintf(stderr, "warning: %s\n", text.c_str()); }};
  // Outlives what reports to it.
  dds::TroubleHandler trouble_ = [this](const Error& error) {
    complaints_.add("trouble", error.to_string());
  };
  std::optional<dds::Participant> participant_;
  std::optional<dds::Reader<ros::LaserScan>> scans_;
  std::optional<dds::Reader<ros::Odometry>> odometry_;
  std::optional<dds::Reader<ros::TFMessage>> static_;
  std::optional<RosOutput> output_;
  std::unique_ptr<dds::WaitLoop> loop_;
  std::thread thread_;
  std::atomic<std::uint64_t> left_out_ = 0, without_mount_ = 0;
  Clock::time_point heard_ = Clock::now();  // of the thread that calls next()

  // Of the thread that takes samples.
  std::optional<std::string> laser_frame_;  ///< of the first scan: the others are left out
  std::size_t beams_ = 0;
  std::string base_frame_;
  StaticTransforms transforms_;
  std::optional<LaserMount> mount_;
  std::optional<Clock::time_point> mount_sought_;
};

Result<void> RosRobot::start() {
  auto participant = dds::Participant::open(settings_.domain, settings_.network);
  if (!participant) return participant.error();
  participant_.emplace(std::move(*participant));
  auto output = RosOutput::make(*participant_, settings_, &trouble_);
  if (!output) return output.error();
  output_.emplace(std::move(*output));
  auto loop = dds::WaitLoop::make(*participant_);
  if (!loop) return loop.error();
  loop_ = std::move(*loop);
  // Scans last: they find what arrived with them.
  if (!settings_.tf_static.empty() && !settings_.T_base_laser) {
    if (auto heard = listen(static_, settings_.tf_static, dds::Traffic::kFixedTransforms,
                            &RosRobot::take_static);
        !heard)
      return heard;
  }
  if (!settings_.odometry.empty()) {
    if (auto heard =
            listen(odometry_, settings_.odometry, dds::Traffic::kSensor, &RosRobot::take_odometry);
        !heard)
      return heard;
  }
  if (auto heard = listen(scans_, settings_.scan, dds::Traffic::kSensor, &RosRobot::take_scans);
      !heard)
    return heard;
  thread_ = std::thread([this] { loop_->run(trouble_); });
  return {};
}

template <class T>
Result<void> RosRobot::listen(std::optional<dds::Reader<T>>& reader, const std::string& topic,
                              dds::Traffic traffic, int (RosRobot::*taker)()) {
  auto made = dds::Reader<T>::make(*participant_, ros::describe<T>(topic, traffic), &trouble_);
  if (!made) return made.error();
  reader.emplace(std::move(*made));
  return loop_->attach(reader->handle(), [this, taker] { return (this->*taker)(); });
}

int RosRobot::take_static() {
  return static_->take([&](const ros::TFMessage& message, const dds_sample_info_t& info) {
    if (info.valid_data) transforms_.add(message);
  });
}

int RosRobot::take_odometry() {
  return odometry_->take([&](const ros::Odometry& message, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    base_frame_ = text_of(message.child_frame_id);
    const Result<StampedPose> pose = to_stamped_pose(message);
    if (pose) return queue_.push(*pose);
    complain("odometry", settings_.odometry,
             "an odometry message (frame '" + quote(text_of(message.header.frame_id)) +
                 "') is left out: " + pose.error().message);
  });
}

int RosRobot::take_scans() {
  return scans_->take([&](const ros::LaserScan& message, const dds_sample_info_t& info) {
    if (info.valid_data) take(message);
  });
}

void RosRobot::take(const ros::LaserScan& message) {
  const std::string frame = text_of(message.header.frame_id);
  if (laser_frame_ && *laser_frame_ != frame) {
    ++left_out_;
    return complain("frame", settings_.scan,
                    "a scan of '" + quote(frame) + "' is left out: the first one was of '" +
                        quote(*laser_frame_) + "'; give each laser a topic of its own");
  }
  Result<LaserScan> scan = to_laser_scan(message);
  if (!scan) {
    ++left_out_;
    return complain("scan", settings_.scan,
                    "a scan of '" + quote(frame) + "' is left out: " + scan.error().message);
  }
  laser_frame_ = frame;
  tell_changes(message);
  if (!mount_ && !find_mount(frame)) return;
  if (mount_->upside_down) turn_upright(*scan);
  if (!queue_.push(std::move(*scan)))
    complain("behind", settings_.scan,
             "the front-end is behind: the oldest of " + std::to_string(ScanQueue::kMost) +
                 " waiting scans is dropped");
}

// Where the laser sits is asked once: a scan that came before the answer would bend the map.
bool RosRobot::find_mount(const std::string& laser) {
  if (settings_.T_base_laser) {
    mount_ = LaserMount{*settings_.T_base_laser};
  } else if (!odometry_ || !static_) {
    mount_ = LaserMount{};
  } else if (const auto T_base_laser = transforms_.T_a_b(base_frame_, laser)) {
    mount_ = to_mount(*T_base_laser);
  } else if (!mount_sought_ || Clock::now() - *mount_sought_ < kMountPatience) {
    if (!mount_sought_) mount_sought_ = Clock::now();
    ++without_mount_;
    return false;
  } else {
    complain("mount", settings_.tf_static,
             "nothing leads from '" + quote(base_frame_) + "' (odometry's child_frame_id) to '" +
                 quote(laser) +
                 "': the laser is taken to be in the robot's middle and to look "
                 "ahead; laser=X/Y/YAW says where it is");
    mount_ = LaserMount{};
  }
  if (mount_->tilt_rad > kMostTiltRad)
    complain("tilt", settings_.tf_static,
             "the laser '" + quote(laser) + "' is tilted by " + std::to_string(mount_->tilt_rad) +
                 " rad; a map needs a level one, and it is taken as level");
  queue_.set_T_base_laser(mount_->T_base_laser);
  return true;
}

void RosRobot::tell_changes(const ros::LaserScan& message) {
  const std::size_t before = std::exchange(beams_, message.ranges._length);
  if (before != 0 && before != beams_)
    complain("beams", settings_.scan,
             "from here on a scan has " + std::to_string(beams_) + " ranges, before " +
                 std::to_string(before));
}

Result<NextFrame> RosRobot::next() {
  std::optional<LaserScan> scan = queue_.pop(Clock::now() + kTurn);
  if (!scan) {
    tell_silence();
    output_->publish_trajectory_when_due();
    return NextFrame(NothingYet());
  }
  heard_ = Clock::now();
  output_->set_T_base_laser(queue_.T_base_laser());
  if (!settings_.odometry.empty() && !scan->T_odom_laser) tell_missing_odometry(*scan);
  return NextFrame(SensorFrame(std::move(*scan)));
}

// A topic without messages looks the same whatever the reason is, but for its publishers.
void RosRobot::tell_silence() {
  if (Clock::now() - heard_ < kSilence) return;
  heard_ = Clock::now();
  dds_subscription_matched_status_t matched{};
  const bool known = dds_get_subscription_matched_status(scans_->handle(), &matched) >= 0;
  if (known && matched.current_count > 0)
    return complain("silence", settings_.scan,
                    "no scan for 10 s, but " + std::to_string(matched.current_count) +
                        " publisher(s) are there: is the laser running?");
  complain("silence", settings_.scan,
           "no scan for 10 s, and nobody publishes this topic: does `ros2 topic info` show it as "
           "sensor_msgs/msg/LaserScan, in this ROS_DOMAIN_ID, on " +
               (settings_.network.interface.empty()
                    ? std::string("this machine (ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST)")
                    : settings_.network.interface) +
               "?");
}

void RosRobot::tell_missing_odometry(const LaserScan& scan) {
  const auto newest = queue_.newest_odometry_ns();
  complain("no odometry", settings_.odometry,
           newest ? "a scan has no odometry of its time: it is stamped " +
                        std::to_string(1e-9 * static_cast<double>(scan.stamp_ns - *newest)) +
                        " s after the newest odometry; do the clocks agree?"
                  : "no odometry has come: the scan is matched without, and map -> odom is not "
                    "published (odom= says that there is none)");
}

std::string RosRobot::report() const {
  const ScanQueue::Counts counts = queue_.counts();
  return settings_.scan + ": " + std::to_string(counts.arrived) + " scans came, " +
         std::to_string(counts.dropped) +
         " of them were dropped because the front-end was behind; " + std::to_string(left_out_) +
         " were left out as unusable; " + std::to_string(counts.without_odometry) +
         " had no odometry" +
         (without_mount_ == 0 ? ""
                              : "; before them " + std::to_string(without_mount_) +
                                    " came before it was known where the laser sits");
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_ros_robot(const std::string& settings,
                                                    std::uint32_t daemon_domain) {
  const Result<RosSettings> parsed = parse_ros_settings(settings);
  if (!parsed) return parsed.error();
  if (parsed->domain == daemon_domain && !parsed->network.interface.empty())
    return Error{ErrorCode::kUsage,
                 "--input ros: interface is given, and domain " + std::to_string(daemon_domain) +
                     " is also the daemon's, which is on this machine's loopback; give one of them "
                     "another domain (domain=N, --domain N), or set CYCLONEDDS_URI for both"};
  auto robot = std::make_unique<RosRobot>(*parsed);
  if (auto started = robot->start(); !started) return started.error();
  return std::unique_ptr<FrameSource>(std::move(robot));
}

}  // namespace cairn
