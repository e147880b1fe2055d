// SPDX-License-Identifier: BSD-3-Clause
// Old poses of revisited places are taken out of the map, and can be brought back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "cairn/history/apply_record.hpp"
#include "cairn/replay/graph_transactions.hpp"
#include "datasets/simulate.hpp"
#include "server/reexecution.hpp"
#include "tests/server/live_service.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class Thinned : public test::LiveService {
 protected:
  void start_thinning() {
    ServiceOptions options{.thin_after_visits = 2, .thin_radius_cm = 150, .thin_angle_deg = 180};
    start(options);
    service_.reset();  // start() has made input never pause: here it must
    client_.reset();
    options.solve_after_pause = 20ms;
    options.on_event = [this](const Event& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(event);
    };
    transport_ = network_.make_transport();
    service_.emplace(*journal_, *transport_, options);
    ASSERT_TRUE(service_->start());
    client_.emplace(*Client::connect(
        {.source = "test", .robot = "robot", .spool = folder_.path() / "spool"},
        [this](Link::Identity identity) { return network_.make_link(std::move(identity)); }));
  }
  // Until nothing more is taken out.
  void wait_until_quiet() {
    std::uint64_t last = 0;
    for (int quiet = 0; quiet < 4; ++quiet) {
      ASSERT_TRUE(client_->command("settle", 60s));
      std::this_thread::sleep_for(250ms);
      const std::uint64_t now = journal_->head().revision.number;
      if (now != last) quiet = 0;
      last = now;
    }
  }
  std::size_t solved_nodes() const {
    const auto maps = maps_at(*journal_, {journal_->head().revision.number});
    EXPECT_TRUE(maps);
    return CanonicalOrder(maps->front()).nodes.size();
  }
};

TEST_F(Thinned, APatrolDoesNotGrowTheMapForEver) {
  start_thinning();
  const auto world = simulate({.world = World::kManhattan, .poses = 1500, .seed = 3});
  ASSERT_TRUE(world);
  const auto steps = graph_transactions(world->graph, [](VariableId id) {
    return NodeId{{"robot", 1}, id.value};
  });
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    submit(steps[i]);
    if ((i + 1) % 500 != 0) continue;
    wait_until_quiet();
    kept.push_back(solved_nodes());
  }
  EXPECT_LT(kept.back(), 1000u) << testing::PrintToString(kept);
  ASSERT_FALSE(events("thinned").empty());
  EXPECT_THAT(events("thinned")[0].text, HasSubstr(" poses of revisited places, "));
  EXPECT_THAT(events("thinned")[0].text, HasSubstr(" nats of information lost"));
  EXPECT_TRUE(events("loop_quarantined").empty());

  // Everything can be brought back, the newest first; what came back stays.
  std::vector<std::uint64_t> orders;
  ASSERT_TRUE(journal_->for_each(1, [&](const Record& record) -> Result<void> {
    if (std::holds_alternative<CommandRecord>(record.body)) orders.push_back(record.number);
    return {};
  }));
  std::reverse(orders.begin(), orders.end());
  for (const std::uint64_t order : orders) {
    const auto undone = client_->command(
        "undo {\"record\":" + std::to_string(order) + ",\"operator\":\"anna\",\"reason\":\"\"}",
        10s);
    ASSERT_TRUE(undone) << undone.error().to_string();
    ASSERT_TRUE(client_->command("settle", 20s));
  }
  EXPECT_GT(solved_nodes(), kept.back() + 100);
  client_.reset();
  service_.reset();
  const auto executed = Reexecution(*journal_).run();
  ASSERT_TRUE(executed) << executed.error().to_string();
  EXPECT_EQ(executed->solves, solves().size());

  // After a restart the daemon goes on under its own name, which nobody else may take.
  transport_ = network_.make_transport();
  service_.emplace(*journal_, *transport_, ServiceOptions{});
  ASSERT_TRUE(service_->start());
  Client thief = *Client::connect(
      {.source = kOwnSource, .robot = "robot", .spool = folder_.path() / "thief"},
      [this](Link::Identity identity) { return network_.make_link(std::move(identity)); });
  const std::uint64_t before = journal_->head().revision.number;
  EXPECT_FALSE(thief.submit(test::drive_step("thief", 0), 300ms)) << "it waits in the spool";
  EXPECT_EQ(journal_->head().revision.number, before);
}

}  // namespace
}  // namespace cairn
