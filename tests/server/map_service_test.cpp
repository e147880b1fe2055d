// SPDX-License-Identifier: BSD-3-Clause
// Maps from a daemon's renderer to its clients' copies, over memory and over the real middleware.
#include "server/map_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "server/dds_transport.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/mapped_room.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::wait_until;
using Tiles = std::map<TileIndex, MapTile>;

constexpr double kResolution = 0.1;

// What an observer in the daemon, or a client's callback, makes of what it is told.
class Followed {
 public:
  void take(const MapChange& change) {
    const std::lock_guard lock(mutex_);
    Tiles& tiles = maps_[change.map];
    for (const auto& [index, tile] : change.changed) {
      tiles[index] = tile;
      told_.insert(index);
    }
    for (const TileIndex& index : change.gone) tiles.erase(index);
  }
  [[nodiscard]] Tiles all() const {
    const std::lock_guard lock(mutex_);
    Tiles all;
    for (const auto& [map, tiles] : maps_) all.insert(tiles.begin(), tiles.end());
    return all;
  }
  /// Tiles of which something was told since this was last asked.
  [[nodiscard]] std::set<TileIndex> take_told() {
    const std::lock_guard lock(mutex_);
    return std::exchange(told_, {});
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Tiles> maps_;
  std::set<TileIndex> told_;
};

class MapServiceTest : public testing::TestWithParam<bool> {
 protected:
  struct Daemon {
    Daemon(const std::filesystem::path& folder, std::unique_ptr<Transport> over,
           MapService::Options maps)
        : journal(*Journal::open(folder.string())),
          transport(std::move(over)),
          service(*journal, *transport, {.solve_after_pause = 20ms, .maps = std::move(maps)}) {
      EXPECT_TRUE(service.start());
    }
    std::unique_ptr<Journal> journal;
    std::unique_ptr<Transport> transport;
    Service service;
  };
  std::unique_ptr<Daemon> start_daemon(MapObserver observer = {}) {
    MapService::Options maps{
        .resolution_m = kResolution, .render_every = 10ms, .on_map = std::move(observer)};
    return std::make_unique<Daemon>(
        folder_.path() / "data",
        GetParam() ? make_dds_transport({.domain = domain_}) : network_.make_transport(),
        std::move(maps));
  }
  Client connect(ClientOptions options) {
    options.domain = domain_;
    if (GetParam()) return *Client::connect(options);
    return *Client::connect(options,
                            [this](Link::Identity who) { return network_.make_link(who); });
  }
  Client connect_robot() {
    return connect({.source = "test", .robot = "robot", .spool = folder_.path() / "spool"});
  }
  Client connect_follower(std::uint32_t budget_bytes = 64u << 10) {
    return connect({.follow_maps = true,
                    .maps = {.budget_bytes = budget_bytes, .pause = 1ms, .patience = 200ms}});
  }
  void drive(Client& robot, std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t i = from; i < to; ++i) {
      const Transaction step = test::mapped_step(test::kLeader, i, [&](const std::string& scan) {
        ASSERT_TRUE(robot.send_payload(std::string(kRangeScanPayload), scan));
      });
      const auto receipt = robot.submit(step, 10s);
      ASSERT_TRUE(receipt) << receipt.error().to_string();
      ASSERT_FALSE(receipt->refusal) << receipt->reason;
    }
    ASSERT_TRUE(wait_until([&] { return robot.unstored_payloads() == 0; }));
    ASSERT_TRUE(robot.command("settle", 20s));
  }
  static bool shows(const Client& client, const Tiles& tiles) {
    const std::vector<MapView> views = client.maps();
    return tiles.empty() ? views.empty()
                         : views.size() == 1 && views[0].missing == 0 && views[0].tiles == tiles;
  }
  Tiles rendered(const Daemon& daemon) {
    return test::render_journal(*daemon.journal, kResolution);
  }

  test::TemporaryFolder folder_;
  MemoryNetwork network_;
  std::uint32_t domain_ = GetParam() ? test::own_domain() : 0;
};

TEST_P(MapServiceTest, ClientsHaveWhatRenderingAnewGives) {
  Followed observed, followed;
  const auto daemon = start_daemon([&](const MapChange& change) { observed.take(change); });
  Client robot = connect_robot();
  Client early = connect_follower();
  early.on_maps([&](const MapChange& change) { followed.take(change); });
  drive(robot, 0, 12);
  const Tiles half = rendered(*daemon);
  ASSERT_GT(half.size(), 10u);
  EXPECT_TRUE(wait_until([&] { return shows(early, half); }));
  drive(robot, 12, 30);
  const Tiles all = rendered(*daemon);
  ASSERT_NE(all, half);
  Client late = connect_follower(limits::kLeastTileBudget);
  EXPECT_TRUE(wait_until([&] { return shows(early, all); }));
  EXPECT_TRUE(wait_until([&] { return shows(late, all); }));
  EXPECT_EQ(followed.all(), all);
  EXPECT_EQ(observed.all(), all);
  EXPECT_EQ(early.maps()[0].resolution_m, kResolution);
}

TEST_P(MapServiceTest, BringsOnlyWhatIsDifferentAfterARestartOfTheDaemon) {
  auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 60);
  ASSERT_TRUE(robot.command("freeze {\"operator\":\"anna\",\"reason\":\"\"}", 20s));
  Followed followed;
  Client client = connect_follower();
  client.on_maps([&](const MapChange& change) { followed.take(change); });
  const Tiles before = rendered(*daemon);
  ASSERT_TRUE(wait_until([&] { return shows(client, before); }));
  EXPECT_GE(followed.take_told().size(), before.size());
  daemon.reset();
  daemon = start_daemon();
  drive(robot, 60, 62);
  const Tiles after = rendered(*daemon);
  ASSERT_NE(before, after);
  EXPECT_TRUE(wait_until([&] { return shows(client, after); }));
  EXPECT_EQ(followed.all(), after);
  // A laser is believed up to 30 m.
  for (const TileIndex& tile : followed.take_told()) EXPECT_GE(tile.x, 3) << tile.y;
}

TEST_P(MapServiceTest, TakesAwayWhatNoScanSaysAnyMore) {
  const auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 20);
  Client client = connect_follower();
  ASSERT_TRUE(wait_until([&] { return shows(client, rendered(*daemon)); }));
  ASSERT_TRUE(robot.command(
      R"(undo {"record":1,"cascade":true,"operator":"anna","reason":"it never was there"})", 20s));
  ASSERT_TRUE(robot.command("settle", 20s));
  EXPECT_TRUE(wait_until([&] { return client.maps().empty(); }));
}

INSTANTIATE_TEST_SUITE_P(Over, MapServiceTest, testing::Bool(), [](const auto& over) {
  return over.param ? std::string("Dds") : std::string("Memory");
});

}  // namespace
}  // namespace cairn
