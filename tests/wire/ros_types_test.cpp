// SPDX-License-Identifier: BSD-3-Clause
// ROS 2's types over DDS. The bytes on the wire are compared with tables written by hand after the
// CDR rules (little endian, every number aligned to its size, strings with their length and a final
// 0), so that a field in the wrong place is seen without a ROS.
#include <dds/ddsi/ddsi_serdata.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "idl/dds/ros_topics.hpp"
#include "tests/support/own_domain.hpp"

namespace cairn {
namespace {

using dds::Traffic;

// Bytes by hand: each number at a multiple of its size, counted from behind the header.
class Cdr {
 public:
  template <class Number>
  Cdr& operator<<(Number number) {
    while ((bytes_.size() - 4) % sizeof number != 0) bytes_.push_back(0);
    const auto* raw = reinterpret_cast<const unsigned char*>(&number);
    bytes_.insert(bytes_.end(), raw, raw + sizeof number);
    return *this;
  }
  Cdr& operator<<(const char* text) {
    const auto length = static_cast<std::uint32_t>(std::strlen(text) + 1);
    *this << length;
    bytes_.insert(bytes_.end(), text, text + length);
    return *this;
  }
  Cdr& header(std::int32_t sec, std::uint32_t nanosec, const char* frame) {
    return *this << sec << nanosec << frame;
  }
  Cdr& numbers(std::initializer_list<double> all) {
    for (const double number : all) *this << number;
    return *this;
  }
  [[nodiscard]] const std::vector<unsigned char>& bytes() const { return bytes_; }

 private:
  std::vector<unsigned char> bytes_{0, 1, 0, 0};  // CDR, little endian
};

// One writer and one reader of T, and what travels between them.
template <class T>
class Wire {
 public:
  explicit Wire(Traffic traffic = Traffic::kLatest) {
    auto participant = dds::Participant::open(test::own_domain(), {});
    EXPECT_TRUE(participant);
    participant_.emplace(std::move(*participant));
    const std::string topic = "rt/test_types";
    auto writer = dds::Writer<T>::make(*participant_, ros::describe<T>(topic, traffic), &trouble_);
    auto reader = dds::Reader<T>::make(*participant_, ros::describe<T>(topic, traffic), &trouble_);
    EXPECT_TRUE(writer);
    EXPECT_TRUE(reader);
    writer_.emplace(std::move(*writer));
    reader_.emplace(std::move(*reader));
  }

  void write(const T& sample) {
    dds_publication_matched_status_t matched{};
    while (dds_get_publication_matched_status(writer_->handle(), &matched) >= 0 &&
           matched.current_count == 0)
      dds_sleepfor(DDS_MSECS(1));
    EXPECT_EQ(writer_->write(sample), DDS_RETCODE_OK);
  }
  // What of `sample` lies on the wire.
  std::vector<unsigned char> bytes(const T& sample) {
    write(sample);
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info;
    while (dds_takecdr(reader_->handle(), &data, 1, &info, DDS_ANY_STATE) == 0)
      dds_sleepfor(DDS_MSECS(1));
    std::vector<unsigned char> bytes(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
    return bytes;
  }
  template <class Visit>
  void round_trip(const T& sample, Visit visit) {
    write(sample);
    int taken = 0;
    while (taken == 0) {
      taken = reader_->take([&](const T& arrived, const dds_sample_info_t& info) {
        ASSERT_TRUE(info.valid_data);
        visit(arrived);
      });
      dds_sleepfor(DDS_MSECS(1));
    }
    EXPECT_EQ(taken, 1);
  }

 private:
  dds::TroubleHandler trouble_;
  std::optional<dds::Participant> participant_;
  std::optional<dds::Writer<T>> writer_;
  std::optional<dds::Reader<T>> reader_;
};

template <class Sequence, class Element>
void borrow(Sequence& sequence, std::vector<Element>& elements) {
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
  sequence._buffer = elements.data();
  sequence._release = false;
}

char* text(const char* literal) { return const_cast<char*>(literal); }

// The wire ends with padding to 4 bytes, whose number stands in the header.
void expect_bytes(std::vector<unsigned char> found, const Cdr& expected) {
  ASSERT_GE(found.size(), 4u);
  const std::size_t padding = found[3] & 3u;
  found[3] = 0;
  found.resize(found.size() - padding);
  EXPECT_EQ(found, expected.bytes());
}

struct Scan {
  std::vector<float> ranges{1.5F, 2.5F}, intensities{9.0F};
  ros::LaserScan message{};
  Scan() {
    message.header = {{7, 8}, text("laser")};
    message.angle_min = -1.0F;
    message.angle_max = 1.0F;
    message.angle_increment = 2.0F;
    message.time_increment = 0.25F;
    message.scan_time = 0.5F;
    message.range_min = 0.125F;
    message.range_max = 30.0F;
    borrow(message.ranges, ranges);
    borrow(message.intensities, intensities);
  }
};

struct Grid {
  std::vector<std::int8_t> cells{-1, 0, 50, 100, 7, 8};
  ros::OccupancyGrid message{};
  Grid() {
    message.header = {{7, 8}, text("map")};
    message.info = {{5, 6}, 0.05F, 3, 2, {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}}};
    borrow(message.data, cells);
  }
};

TEST(RosTypes, HaveTheNamesThatRosNodesLookFor) {
  EXPECT_STREQ(ros::descriptor_of<ros::LaserScan>()->m_typename,
               "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_STREQ(ros::descriptor_of<ros::Odometry>()->m_typename, "nav_msgs::msg::dds_::Odometry_");
  EXPECT_STREQ(ros::descriptor_of<ros::Path>()->m_typename, "nav_msgs::msg::dds_::Path_");
  EXPECT_STREQ(ros::descriptor_of<ros::OccupancyGrid>()->m_typename,
               "nav_msgs::msg::dds_::OccupancyGrid_");
  EXPECT_STREQ(ros::descriptor_of<ros::OccupancyGridUpdate>()->m_typename,
               "map_msgs::msg::dds_::OccupancyGridUpdate_");
  EXPECT_STREQ(ros::descriptor_of<ros::TFMessage>()->m_typename, "tf2_msgs::msg::dds_::TFMessage_");
}

TEST(RosTypes, AScanLiesOnTheWireAsByHand) {
  const Scan scan;
  Cdr cdr;
  cdr.header(7, 8, "laser");
  for (const float number : {-1.0F, 1.0F, 2.0F, 0.25F, 0.5F, 0.125F, 30.0F}) cdr << number;
  cdr << 2U << 1.5F << 2.5F << 1U << 9.0F;
  expect_bytes(Wire<ros::LaserScan>().bytes(scan.message), cdr);
}

TEST(RosTypes, AGridLiesOnTheWireAsByHand) {
  const Grid grid;
  Cdr cdr;
  cdr.header(7, 8, "map");
  cdr << 5 << 6U << 0.05F << 3U << 2U;
  cdr.numbers({1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.4});
  cdr << 6U;
  for (const std::int8_t cell : grid.cells) cdr << cell;
  expect_bytes(Wire<ros::OccupancyGrid>().bytes(grid.message), cdr);
}

TEST(RosTypes, AnUpdateLiesOnTheWireAsByHand) {
  std::vector<std::int8_t> cells{100, -1};
  ros::OccupancyGridUpdate update{};
  update.header = {{7, 8}, text("map")};
  update.x = -3;
  update.y = 4;
  update.width = 2;
  update.height = 1;
  borrow(update.data, cells);
  Cdr cdr;
  cdr.header(7, 8, "map") << -3 << 4 << 2U << 1U << 2U << std::int8_t{100} << std::int8_t{-1};
  expect_bytes(Wire<ros::OccupancyGridUpdate>().bytes(update), cdr);
}

TEST(RosTypes, OdometryLiesOnTheWireAsByHand) {
  ros::Odometry odometry{};
  odometry.header = {{7, 8}, text("odom")};
  odometry.child_frame_id = text("base_link");
  odometry.pose.pose = {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}};
  odometry.twist.twist = {{4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}};
  for (int i = 0; i < 36; ++i) {
    odometry.pose.covariance[i] = 100 + i;
    odometry.twist.covariance[i] = 200 + i;
  }
  Cdr cdr;
  cdr.header(7, 8, "odom") << "base_link";
  cdr.numbers({1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.4});
  for (int i = 0; i < 36; ++i) cdr << 100.0 + i;
  cdr.numbers({4.0, 5.0, 6.0, 7.0, 8.0, 9.0});
  for (int i = 0; i < 36; ++i) cdr << 200.0 + i;
  expect_bytes(Wire<ros::Odometry>().bytes(odometry), cdr);
}

TEST(RosTypes, ATransformAndAPathLieOnTheWireAsByHand) {
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms{
      {{{7, 8}, text("map")}, text("odom"), {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}}}};
  ros::TFMessage tf{};
  borrow(tf.transforms, transforms);
  Cdr tf_cdr;
  (tf_cdr << 1U).header(7, 8, "map") << "odom";
  tf_cdr.numbers({1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.4});
  expect_bytes(Wire<ros::TFMessage>(Traffic::kTransforms).bytes(tf), tf_cdr);

  std::vector<geometry_msgs_msg_dds__PoseStamped_> poses{
      {{{7, 8}, text("map")}, {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}}},
      {{{9, 0}, text("map")}, {{4.0, 5.0, 6.0}, {0.0, 0.0, 0.0, 1.0}}}};
  ros::Path path{};
  path.header = {{9, 0}, text("map")};
  borrow(path.poses, poses);
  Cdr path_cdr;
  path_cdr.header(9, 0, "map") << 2U;
  path_cdr.header(7, 8, "map").numbers({1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.4});
  path_cdr.header(9, 0, "map").numbers({4.0, 5.0, 6.0, 0.0, 0.0, 0.0, 1.0});
  expect_bytes(Wire<ros::Path>().bytes(path), path_cdr);
}

TEST(RosTypes, ComeBackAsTheyWere) {
  const Scan scan;
  Wire<ros::LaserScan>().round_trip(scan.message, [&](const auto& arrived) {
    EXPECT_STREQ(arrived.header.frame_id, "laser");
    EXPECT_EQ(arrived.header.stamp.nanosec, 8u);
    EXPECT_EQ(arrived.range_max, 30.0F);
    EXPECT_EQ(
        std::vector<float>(arrived.ranges._buffer, arrived.ranges._buffer + arrived.ranges._length),
        scan.ranges);
    EXPECT_EQ(arrived.intensities._length, 1u);
  });
  const Grid grid;
  Wire<ros::OccupancyGrid>().round_trip(grid.message, [&](const auto& arrived) {
    EXPECT_EQ(arrived.info.origin.orientation.w, 0.4);
    EXPECT_EQ(
        std::vector<std::int8_t>(arrived.data._buffer, arrived.data._buffer + arrived.data._length),
        grid.cells);
  });
}

TEST(RosTopics, HaveNamesOfRos) {
  EXPECT_EQ(*ros::topic_name("scan"), "rt/scan");
  EXPECT_EQ(*ros::topic_name("/front/scan_1"), "rt/front/scan_1");
  for (const std::string& bad :
       {std::string(), std::string("/"), std::string("a//b"), std::string("a/"), std::string("a b"),
        std::string("//a"), std::string("a\n"), std::string(201, 'a')})
    EXPECT_FALSE(ros::topic_name(bad)) << bad;
}

TEST(RosTopics, StampsAreChecked) {
  EXPECT_EQ(ros::stamp_ns({7, 8}), 7'000'000'008);
  EXPECT_FALSE(ros::stamp_ns({-1, 0}));
  EXPECT_FALSE(ros::stamp_ns({1, 1'000'000'000}));
  const ros::Time time = ros::to_time(7'000'000'008);
  EXPECT_EQ(time.sec, 7);
  EXPECT_EQ(time.nanosec, 8u);
  EXPECT_EQ(ros::to_time(-5).sec, 0);
  EXPECT_EQ(ros::to_time(INT64_MAX).sec, INT32_MAX);
}

}  // namespace
}  // namespace cairn
