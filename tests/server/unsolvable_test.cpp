// SPDX-License-Identifier: BSD-3-Clause
// A map that cannot be solved: the service goes on, and says so once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <thread>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

class UnsolvableMap : public testing::Test {
 protected:
  UnsolvableMap() {
    ServiceOptions options{.solve_after_pause = 20ms};
    options.on_event = [&](const Event& event) {
      const std::lock_guard lock(mutex_);
      events_[event.kind].push_back(event.text);
    };
    service_.emplace(*journal_, *transport_, options);
    EXPECT_TRUE(service_->start());
  }
  Client connect(const std::string& source) {
    return *Client::connect(
        {.source = source, .robot = source, .spool = folder_.path() / source},
        [&](Link::Identity identity) { return network_.make_link(std::move(identity)); });
  }
  static Revision submit(Client& client, const Transaction& step) {
    const auto receipt = client.submit(step, 10s);
    EXPECT_TRUE(receipt) << receipt.error().to_string();
    if (!receipt) return {};
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
    return receipt->revision;
  }
  std::vector<std::string> told(const std::string& kind) {
    const std::lock_guard lock(mutex_);
    return events_[kind];
  }
  std::vector<std::string> wait_until_told(const std::string& kind) {
    for (int i = 0; i < 1000 && told(kind).empty(); ++i) std::this_thread::sleep_for(10ms);
    return told(kind);
  }

  const test::TemporaryFolder folder_;
  MemoryNetwork network_;
  std::unique_ptr<Journal> journal_ = *Journal::open((folder_.path() / "data").string());
  std::unique_ptr<Transport> transport_ = network_.make_transport();
  std::mutex mutex_;
  std::map<std::string, std::vector<std::string>> events_;
  std::optional<Service> service_;
};

// With an error that overflows.
std::vector<Transaction> broken_drive(std::uint64_t count) {
  auto steps = test::drive(count);
  for (double& number : steps.back().factors.front().numbers) number *= 1e200;
  return steps;
}

TEST_F(UnsolvableMap, IsToldOnceAndTriedAgainWhenAsked) {
  Client client = connect("test");
  for (const Transaction& step : broken_drive(3)) submit(client, step);
  ASSERT_EQ(wait_until_told("solve_failed").size(), 1u);
  EXPECT_EQ(told("solve_failed")[0],
            "3 nodes cannot be solved (not_finite) and stay where they were: robot/3/0, robot/3/1, "
            "robot/3/2; the largest error is that of factor 0 in record 3 (test, sequence 3): "
            "cairn undo takes it back");
  std::this_thread::sleep_for(300ms);  // many pauses of the input
  EXPECT_EQ(told("solve_failed").size(), 1u);
  const auto settled = client.command("settle", 10s);
  ASSERT_FALSE(settled);
  EXPECT_EQ(settled.error().code, ErrorCode::kNotUsable);
  EXPECT_THAT(settled.error().message, testing::HasSubstr("the map cannot be settled ("));
  EXPECT_EQ(told("solve_failed").size(), 2u);
}

TEST_F(UnsolvableMap, DoesNotHoldUpTheOthers) {
  Client broken = connect("test");
  for (const Transaction& step : broken_drive(3)) submit(broken, step);
  ASSERT_FALSE(wait_until_told("solve_failed").empty());
  Client healthy = connect("other");
  Revision last;
  std::vector<Transaction> steps;
  for (std::uint64_t i = 1; i < 10; ++i) {  // 0 would tie it to the broken one
    steps.push_back(test::drive_step("other", i));
    if (i == 1) steps.back().factors.clear();
    if (i == 7) steps.back().factors.pop_back();
    last = submit(healthy, steps.back());
  }
  ASSERT_TRUE(healthy.wait_solved(last, 10s));
  EXPECT_FALSE(healthy.command("settle", 10s));
  EXPECT_TRUE(
      broken.command("undo {\"record\":3,\"operator\":\"anna\",\"reason\":\"wheel\"}", 10s));
  const auto settled = healthy.command("settle", 10s);
  EXPECT_TRUE(settled) << settled.error().to_string();
}

TEST_F(UnsolvableMap, NamesWhatNoMeasurementDetermines) {
  Client client = connect("test");
  auto steps = test::drive(3);
  Transaction& last = steps.back();
  last.factors[0].numbers[8] = 0.0;  // no information on the heading
  for (const Transaction& step : steps) submit(client, step);
  ASSERT_EQ(wait_until_told("under_constrained").size(), 1u);
  EXPECT_THAT(
      told("under_constrained")[0],
      testing::StartsWith("robot/3/2 of record 3 (test, sequence 3) is free in 1 direction, "
                          "("));
  EXPECT_THAT(told("under_constrained")[0],
              testing::EndsWith("): what no measurement determines stays where it was sent"));
  ASSERT_TRUE(client.command("settle", 10s));
  EXPECT_EQ(told("under_constrained").size(), 1u);  // the same once more
}

}  // namespace
}  // namespace cairn
