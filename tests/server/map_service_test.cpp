// SPDX-License-Identifier: BSD-3-Clause
// Maps from a daemon's renderer to its clients' copies, over memory and over the real middleware.
#include "server/map_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
  ASSERT_TRUE(all != half);
  Client late = connect_follower(limits::kLeastTileBudget);
  EXPECT_TRUE(wait_until([&] { return shows(early, all); }));
  EXPECT_TRUE(wait_until([&] { return shows(late, all); }));
  EXPECT_TRUE(wait_until([&] { return followed.all() == all; }));
  EXPECT_TRUE(wait_until([&] { return observed.all() == all; }));
  EXPECT_EQ(early.maps()[0].resolution_m, kResolution);
}

TEST_P(MapServiceTest, BringsOnlyWhatIsDifferentAfterARestartOfTheDaemon) {
  auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 60);
  ASSERT_TRUE(robot.command("freeze {\"operator\":\"anna\",\"reason\":\"\"}", 20s));
  ASSERT_TRUE(robot.command("settle", 20s));  // of what is frozen: it may differ in the last bits
  Followed followed;
  Client client = connect_follower();
  client.on_maps([&](const MapChange& change) { followed.take(change); });
  const Tiles before = rendered(*daemon);
  ASSERT_TRUE(wait_until([&] { return shows(client, before); }));
  ASSERT_TRUE(wait_until([&] { return followed.all() == before; }));  // told after it is shown
  EXPECT_GE(followed.take_told().size(), before.size());
  daemon.reset();
  daemon = start_daemon();
  drive(robot, 60, 62);
  const Tiles after = rendered(*daemon);
  ASSERT_TRUE(before != after);
  EXPECT_TRUE(wait_until([&] { return shows(client, after); }));
  EXPECT_TRUE(wait_until([&] { return followed.all() == after; }));
  // A laser is believed up to 30 m. What is nearer to the start is brought again only where some
  // rendering in between was different: seldom, and a few tiles then.
  const std::set<TileIndex> told = followed.take_told();
  const auto near = std::count_if(told.begin(), told.end(), [](TileIndex t) { return t.x < 3; });
  EXPECT_LT(4 * static_cast<std::size_t>(near), before.size());
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

TEST_P(MapServiceTest, RendersScansThatComeLate) {
  const auto daemon = start_daemon();
  Client robot = connect_robot();
  std::vector<std::string> late;
  for (std::uint64_t i = 0; i < 5; ++i)
    ASSERT_TRUE(robot.submit(
        test::mapped_step(test::kLeader, i, [&](const std::string& scan) { late.push_back(scan); }),
        10s));
  Client client = connect_follower();
  ASSERT_TRUE(robot.command("settle", 20s));
  for (const std::string& scan : late) {
    ASSERT_TRUE(robot.send_payload(std::string(kRangeScanPayload), scan));
    ASSERT_TRUE(wait_until([&] { return robot.unstored_payloads() == 0; }));
    EXPECT_TRUE(wait_until([&] { return shows(client, rendered(*daemon)); }));
  }
}

TEST_P(MapServiceTest, KeepsMapsApartThatNothingTies) {
  const auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 10);
  Client other = connect({.source = "other", .robot = "other", .spool = folder_.path() / "other"});
  for (std::uint64_t i = 1; i < 8; ++i) {  // step 0 would tie it to the leader
    Transaction step = test::mapped_step("other", i, [&](const std::string& scan) {
      ASSERT_TRUE(other.send_payload(std::string(kRangeScanPayload), scan));
    });
    if (i == 1) step.factors.clear();
    std::erase_if(step.factors, [](const NewFactor& f) { return f.kind == FactorKind::kLoop; });
    const auto receipt = other.submit(step, 10s);
    ASSERT_TRUE(receipt && !receipt->refusal) << receipt->reason;
  }
  Client client = connect_follower();
  EXPECT_TRUE(wait_until([&] {
    const auto maps = client.maps();
    return maps.size() == 2 && maps[0].missing == 0 && maps[1].missing == 0 &&
           maps[0].map == "other/3" && maps[1].map == "robot/3" && !maps[0].tiles.empty();
  }));
}

TEST_P(MapServiceTest, TellsWhoAsksForTooLittle) {
  const auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 4);
  if (!GetParam()) return;  // only the wire refuses it
  Client client = connect_follower(100);
  std::mutex mutex;
  std::string told;
  client.on_trouble([&](const Error& error) {
    const std::lock_guard lock(mutex);
    told = error.to_string();
  });
  EXPECT_TRUE(wait_until([&] {
    const std::lock_guard lock(mutex);
    return !told.empty();
  }));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(told, testing::HasSubstr("budget is 100 bytes; expected 8192 to 1048576"));
}

INSTANTIATE_TEST_SUITE_P(Over, MapServiceTest, testing::Bool(), [](const auto& over) {
  return over.param ? std::string("Dds") : std::string("Memory");
});

class MapServiceOverMemory : public MapServiceTest {};

// A link that loses two of three requests.
class LosingLink final : public Link {
 public:
  explicit LosingLink(std::unique_ptr<Link> link) : link_(std::move(link)) {}
  Result<void> start(LinkListener& listener) override { return link_->start(listener); }
  void stop() noexcept override { link_->stop(); }
  Result<void> send(const Transaction& transaction) override { return link_->send(transaction); }
  Result<void> send(const ClientState& state) override { return link_->send(state); }
  Result<void> send(const Payload& payload) override { return link_->send(payload); }
  Result<void> send(const TileRequest& request) override {
    return request.number % 3 == 0 ? link_->send(request) : Result<void>();
  }
  Result<void> send(const Command& command, int timeout_ms) override {
    return link_->send(command, timeout_ms);
  }

 private:
  std::unique_ptr<Link> link_;
};

TEST_P(MapServiceOverMemory, AsksAgainForWhatWasLost) {
  const auto daemon = start_daemon();
  Client robot = connect_robot();
  drive(robot, 0, 20);
  Client client = *Client::connect(
      {.follow_maps = true, .maps = {.budget_bytes = 8u << 10, .pause = 1ms, .patience = 10ms}},
      [this](Link::Identity who) {
        return std::make_unique<LosingLink>(network_.make_link(std::move(who)));
      });
  EXPECT_TRUE(wait_until([&] { return shows(client, rendered(*daemon)); }));
}

TEST_P(MapServiceOverMemory, SaysWhenMemoryDoesNotSuffice) {
  std::atomic<int> told{0};
  const auto journal = *Journal::open((folder_.path() / "data").string());
  const auto transport = network_.make_transport();
  Service service(
      *journal, *transport,
      {.solve_after_pause = 20ms,
       .maps = {.resolution_m = kResolution, .render_every = 1ms, .most_bytes = 10u << 15},
       .on_event = [&](const Event& event) { told += event.kind == "map_full"; }});
  ASSERT_TRUE(service.start());
  Client robot = connect_robot();
  drive(robot, 0, 20);
  EXPECT_TRUE(wait_until([&] { return told > 0; }));
  Client client = connect_follower();
  // What has found room is served.
  EXPECT_TRUE(wait_until([&] {
    const auto maps = client.maps();
    return maps.size() == 1 && maps[0].missing == 0 && !maps[0].tiles.empty();
  }));
  drive(robot, 20, 30);
  EXPECT_EQ(told, 1);
}

INSTANTIATE_TEST_SUITE_P(Over, MapServiceOverMemory, testing::Values(false));

}  // namespace
}  // namespace cairn
