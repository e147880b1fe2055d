// SPDX-License-Identifier: BSD-3-Clause
// A robot on Fast DDS, as ROS 2's default middleware is: publishes the scans and the odometry of a
// simulated drive, and prints what comes back.
//   fast_dds_robot DOMAIN SCANS HZ SECONDS_AFTER [first stamp in s]
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <thread>

#include "frontends/simulated/simulated_drive.hpp"
#include "tests/ros/fast_dds_types.hpp"
#include "tests/ros/mount.hpp"

namespace {

using namespace eprosima::fastdds::dds;
using cairn::Se2;

void fail(const char* what) {
  std::fprintf(stderr, "fast_dds_robot: %s\n", what);
  std::exit(1);
}

DomainParticipant* join(std::uint32_t domain) {
  DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().user_transports.push_back(udp);
  for (std::uint32_t index = 0; index < 10; ++index) {
    eprosima::fastrtps::rtps::Locator_t peer;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
    peer.port = 7400 + 250 * domain + 10 + 2 * index;
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  }
  DomainParticipant* participant =
      DomainParticipantFactory::get_instance()->create_participant(domain, qos);
  if (participant == nullptr) fail("cannot join the domain");
  return participant;
}

template <class T>
Topic* topic_of(DomainParticipant* in, const char* name) {
  const TypeSupport type(new fast::CdrType<T>());
  type.register_type(in);
  Topic* made = in->create_topic(name, T::kType, TOPIC_QOS_DEFAULT);
  if (made == nullptr) fail(name);
  return made;
}

template <class T>
DataWriter* writer(DomainParticipant* in, const char* name, ReliabilityQosPolicyKind reliability,
                   DurabilityQosPolicyKind durability = VOLATILE_DURABILITY_QOS) {
  DataWriterQos qos;
  qos.reliability().kind = reliability;
  qos.durability().kind = durability;
  qos.history().depth = 10;
  qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};  // late readers: not 3 s
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  static Publisher* publisher = in->create_publisher(PUBLISHER_QOS_DEFAULT);
  DataWriter* made = publisher->create_datawriter(topic_of<T>(in, name), qos);
  if (made == nullptr) fail(name);
  return made;
}

template <class T>
DataReader* reader(DomainParticipant* in, const char* name, DurabilityQosPolicyKind durability,
                   int depth) {
  DataReaderQos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = durability;
  qos.history().depth = depth;
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  static Subscriber* subscriber = in->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  return subscriber->create_datareader(topic_of<T>(in, name), qos);
}

template <class T, class Visit>
void take(DataReader* from, Visit visit) {
  T sample;
  SampleInfo info;
  while (from->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK)
    if (info.valid_data) visit(sample);
}

fast::Header header(const char* frame, std::int64_t stamp_ns) {
  return {static_cast<std::int32_t>(stamp_ns / 1'000'000'000),
          static_cast<std::uint32_t>(stamp_ns % 1'000'000'000), frame};
}

double stamp_s(const fast::Header& header) { return header.sec + 1e-9 * header.nanosec; }
double yaw(const fast::Pose& pose) { return 2.0 * std::atan2(pose.qz, pose.qw); }

// Cells of a grid by value, and one number that depends on where they are.
void print_grid(const char* name, const fast::OccupancyGrid& grid) {
  std::size_t unknown = 0, free = 0, occupied = 0, odd = 0;
  for (const std::uint8_t raw : grid.data) {
    const auto cell = static_cast<std::int8_t>(raw);
    unknown += cell == -1;
    free += cell >= 0 && cell < 50;
    occupied += cell >= 50 && cell <= 100;
    odd += cell < -1 || cell > 100;
  }
  std::printf("%s %s %u %u %g %g %g unknown %zu free %zu occupied %zu odd %zu of %zu\n", name,
              grid.header.frame_id.c_str(), grid.width, grid.height, grid.resolution, grid.origin.x,
              grid.origin.y, unknown, free, occupied, odd, grid.data.size());
}

struct Robot {
  DomainParticipant* in;
  DataWriter* scans;
  DataWriter* odometry;
  DataWriter* fixed;
  DataReader* tf;
  DataReader* path;
  DataReader* map;
  DataReader* updates;
  std::size_t transforms = 0, grids = 0, patches = 0;
  fast::OccupancyGrid grid{};

  explicit Robot(std::uint32_t domain)
      : in(join(domain)),
        scans(writer<fast::LaserScan>(in, "rt/scan", BEST_EFFORT_RELIABILITY_QOS)),
        odometry(writer<fast::Odometry>(in, "rt/odom", RELIABLE_RELIABILITY_QOS)),
        fixed(writer<fast::TFMessage>(in, "rt/tf_static", RELIABLE_RELIABILITY_QOS,
                                      TRANSIENT_LOCAL_DURABILITY_QOS)),
        tf(reader<fast::TFMessage>(in, "rt/tf", VOLATILE_DURABILITY_QOS, 100)),
        path(reader<fast::Path>(in, "rt/trajectory", TRANSIENT_LOCAL_DURABILITY_QOS, 1)),
        map(reader<fast::OccupancyGrid>(in, "rt/map", TRANSIENT_LOCAL_DURABILITY_QOS, 1)),
        updates(reader<fast::OccupancyGridUpdate>(in, "rt/map_updates", VOLATILE_DURABILITY_QOS,
                                                  100)) {}

  void wait_for_peers() const {
    int patience = 0;  // odometry and transforms may be switched off
    for (int i = 0; i < 3000; ++i) {
      PublicationMatchedStatus s, o;
      SubscriptionMatchedStatus t, p;
      scans->get_publication_matched_status(s);
      odometry->get_publication_matched_status(o);
      tf->get_subscription_matched_status(t);
      path->get_subscription_matched_status(p);
      const bool needed = s.current_count > 0 && p.current_count > 0;
      if (needed && ((o.current_count > 0 && t.current_count > 0) || ++patience > 200)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    fail("nobody subscribes to rt/scan and publishes rt/trajectory");
  }

  void publish_mount() const {
    const Se2 T = cairn::test::T_base_laser();
    fast::TFMessage message;
    message.transforms.push_back(
        {header("base_link", 0),
         "laser",
         {T.x(), T.y(), 0.3, 0, 0, std::sin(0.5 * T.theta()), std::cos(0.5 * T.theta())}});
    fixed->write(&message);
  }

  // The laser of the drive sits on a base like ROS's, away from its middle and turned.
  void publish(const cairn::LaserScan& scan, std::int64_t first_stamp_ns) const {
    const std::int64_t stamp_ns = first_stamp_ns + scan.stamp_ns;
    const Se2 T_odom_base = *scan.T_odom_laser * cairn::test::T_base_laser().inverse();
    fast::Odometry moved;
    moved.header = header("odom", stamp_ns);
    moved.child_frame_id = "base_link";
    moved.pose = {T_odom_base.x(),
                  T_odom_base.y(),
                  0,
                  0,
                  0,
                  std::sin(0.5 * T_odom_base.theta()),
                  std::cos(0.5 * T_odom_base.theta())};
    odometry->write(&moved);
    fast::LaserScan seen;
    seen.header = header("laser", stamp_ns);
    seen.angle_min = static_cast<float>(scan.first_angle_rad);
    seen.angle_increment = static_cast<float>(scan.angle_step_rad);
    seen.angle_max =
        seen.angle_min + static_cast<float>(scan.ranges_m.size() - 1) * seen.angle_increment;
    seen.range_min = 0.05F;
    seen.range_max = static_cast<float>(scan.max_range_m);
    seen.ranges = scan.ranges_m;
    scans->write(&seen);
  }

  void listen() {
    take<fast::TFMessage>(tf, [&](const fast::TFMessage& message) {
      for (const auto& t : message.transforms) {
        ++transforms;
        std::printf("tf %s %s %.9f %.9f %.9f %.9f\n", t.header.frame_id.c_str(),
                    t.child_frame_id.c_str(), stamp_s(t.header), t.transform.x, t.transform.y,
                    yaw(t.transform));
      }
    });
    take<fast::Path>(path, [&](const fast::Path& message) {
      const auto& last = message.poses.back();
      std::printf("path %s %zu %.9f %.9f %.9f %.9f\n", message.header.frame_id.c_str(),
                  message.poses.size(), stamp_s(last.header), last.pose.x, last.pose.y,
                  yaw(last.pose));
    });
    take<fast::OccupancyGrid>(map, [&](const fast::OccupancyGrid& message) {
      ++grids;
      grid = message;
      print_grid("map", grid);
    });
    take<fast::OccupancyGridUpdate>(updates, [&](const fast::OccupancyGridUpdate& patch) {
      ++patches;
      for (std::uint32_t row = 0; row < patch.height; ++row)
        for (std::uint32_t column = 0; column < patch.width; ++column) {
          const auto x = static_cast<std::int64_t>(column) + patch.x;
          const auto y = static_cast<std::int64_t>(row) + patch.y;
          if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) fail("an update lies outside");
          grid.data[static_cast<std::size_t>(y) * grid.width + static_cast<std::size_t>(x)] =
              patch.data[static_cast<std::size_t>(row) * patch.width + column];
        }
    });
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) fail("expected DOMAIN SCANS HZ SECONDS_AFTER [FIRST_STAMP_S]");
  const auto scans = static_cast<std::size_t>(std::atoi(argv[2]));
  const auto pause = std::chrono::microseconds(1'000'000 / std::atoi(argv[3]));
  const std::int64_t first_stamp_ns =
      (argc > 5 ? std::atoll(argv[5]) : 1'700'000'000) * 1'000'000'000;
  const cairn::SimulatedDrive drive = cairn::simulate_drive();
  Robot robot(static_cast<std::uint32_t>(std::atoi(argv[1])));
  robot.wait_for_peers();
  robot.publish_mount();
  std::this_thread::sleep_for(std::chrono::seconds(1));  // the other side matches later
  auto turn = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < std::min(scans, drive.scans.size()); ++i) {
    robot.publish(drive.scans[i], first_stamp_ns);
    robot.listen();
    std::this_thread::sleep_until(turn += pause);
  }
  const auto end = turn + std::chrono::seconds(std::atoi(argv[4]));
  while (std::chrono::steady_clock::now() < end) {
    robot.listen();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::printf("transforms %zu grids %zu patches %zu\n", robot.transforms, robot.grids,
              robot.patches);
  if (robot.grids > 0) print_grid("patched", robot.grid);
  std::fflush(stdout);
  std::_Exit(0);  // Fast DDS takes its time to leave
}
