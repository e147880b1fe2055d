// SPDX-License-Identifier: BSD-3-Clause
// A map as ROS nodes hear it, over real DDS.
#include "server/ros_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/own_domain.hpp"

namespace cairn {
namespace {

using std::chrono::milliseconds;

MapTile tile_of(TileCell cell) {
  MapTile tile;
  tile.fill(cell);
  return tile;
}

// A ROS node that keeps what it hears.
class Node {
 public:
  Node() {
    auto participant = dds::Participant::open(test::own_domain(), {});
    EXPECT_TRUE(participant);
    participant_.emplace(std::move(*participant));
    auto map = dds::Reader<ros::OccupancyGrid>::make(
        *participant_, ros::describe<ros::OccupancyGrid>("rt/map", dds::Traffic::kLatest),
        &trouble_);
    auto updates = dds::Reader<ros::OccupancyGridUpdate>::make(
        *participant_,
        ros::describe<ros::OccupancyGridUpdate>("rt/map_updates", dds::Traffic::kTransforms),
        &trouble_);
    EXPECT_TRUE(map && updates);
    map_.emplace(std::move(*map));
    updates_.emplace(std::move(*updates));
  }

  struct Heard {
    double origin_x_m = 0.0;
    std::uint32_t width = 0, height = 0;
    std::int32_t x = 0, y = 0;
    std::string frame;
    std::vector<std::int8_t> cells;
  };
  // The next one, which must come.
  Heard map() {
    return wait<ros::OccupancyGrid>(*map_, [](const ros::OccupancyGrid& m) {
      return Heard{m.info.origin.position.x,
                   m.info.width,
                   m.info.height,
                   0,
                   0,
                   m.header.frame_id,
                   {m.data._buffer, m.data._buffer + m.data._length}};
    });
  }
  Heard update() {
    return wait<ros::OccupancyGridUpdate>(*updates_, [](const ros::OccupancyGridUpdate& u) {
      return Heard{0.0,
                   u.width,
                   u.height,
                   u.x,
                   u.y,
                   u.header.frame_id,
                   {u.data._buffer, u.data._buffer + u.data._length}};
    });
  }

 private:
  template <class T, class Read>
  Heard wait(dds::Reader<T>& reader, Read read) {
    std::optional<Heard> heard;
    for (int i = 0; i < 10'000 && !heard; ++i) {
      reader.take([&](const T& sample, const dds_sample_info_t& info) {
        if (info.valid_data) heard = read(sample);
      });
      dds_sleepfor(DDS_MSECS(1));
    }
    EXPECT_TRUE(heard) << "nothing came";
    return heard.value_or(Heard{});
  }

  dds::TroubleHandler trouble_;
  std::optional<dds::Participant> participant_;
  std::optional<dds::Reader<ros::OccupancyGrid>> map_;
  std::optional<dds::Reader<ros::OccupancyGridUpdate>> updates_;
};

class RosMapTest : public testing::Test {
 protected:
  void open(RosMapOptions options) {
    options.map = "/map";
    options.domain = test::own_domain();
    auto opened =
        RosMap::open(options, [](const Error& error) { ADD_FAILURE() << error.to_string(); });
    ASSERT_TRUE(opened) << opened.error().message;
    map_ = std::move(*opened);
  }
  void take(const std::string& name, TileIndex tile, TileCell cell) {
    map_->take(name, {{tile, tile_of(cell)}}, {}, 0.05);
  }
  std::unique_ptr<RosMap> map_;
};

TEST_F(RosMapTest, IsPublishedWholeThenItsChangesThenWholeForThoseWhoComeLater) {
  open({.frame = "hall",
        .whole_every = milliseconds(1),
        .updates_every = milliseconds(1),
        .renew_every = milliseconds(300)});
  Node node;
  take("a/1", {0, 0}, TileCell::kFree);
  const auto whole = node.map();
  EXPECT_EQ(whole.frame, "hall");
  EXPECT_EQ(whole.width, 64u);
  EXPECT_THAT(whole.cells, testing::Each(0));
  dds_sleepfor(DDS_MSECS(100));  // both ends know each other
  take("a/1", {0, 0}, TileCell::kOccupied);
  const auto update = node.update();
  EXPECT_EQ(update.width, 64u);
  EXPECT_EQ(update.frame, "hall");
  EXPECT_THAT(update.cells, testing::Each(100));
  EXPECT_THAT(node.map().cells, testing::Each(100));  // once more, for:
  Node late;
  EXPECT_THAT(late.map().cells, testing::Each(100));
  take("a/1", {-1, 0}, TileCell::kFree);  // grows
  const auto grown = node.map();
  EXPECT_EQ(grown.width, 128u);
  EXPECT_DOUBLE_EQ(grown.origin_x_m, -3.2);
}

TEST_F(RosMapTest, StaysWithOneMapUntilThatIsStillOrGone) {
  open({.whole_every = milliseconds(1),
        .updates_every = milliseconds(1),
        .silence = milliseconds(500)});
  Node node;
  take("a/1", {0, 0}, TileCell::kFree);
  EXPECT_THAT(node.map().cells, testing::Each(0));
  take("b/1", {0, 0}, TileCell::kOccupied);  // has to wait until a/1 has been still
  EXPECT_THAT(node.map().cells, testing::Each(100));
  map_->take("b/1", {}, {{0, 0}}, 0.05);  // became part of the other
  take("a/1", {1, 0}, TileCell::kFree);
  auto map = node.map();
  for (int i = 0; i < 20 && map.width != 128u; ++i)
    map = node.map();  // a/1 as it was may come first
  EXPECT_EQ(map.width, 128u);
}

TEST(RosMapNames, AreThoseOfRos) {
  const auto opened = RosMap::open({.map = "/my map", .domain = test::own_domain()}, {});
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, testing::HasSubstr("'/my map' is no name of a ROS topic"));
}

}  // namespace
}  // namespace cairn
