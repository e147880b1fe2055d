// SPDX-License-Identifier: BSD-3-Clause
// A map that cannot be solved: the service goes on, and says so once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

TEST(UnsolvableMap, IsToldOnceAndTriedAgainWhenAsked) {
  const test::TemporaryFolder folder;
  MemoryNetwork network;
  const auto journal = *Journal::open((folder.path() / "data").string());
  const auto transport = network.make_transport();
  std::atomic<int> failures{0};
  ServiceOptions options{.solve_after_pause = 20ms};
  options.on_event = [&](const Event& event) { failures += event.kind == "solve_failed"; };
  Service service(*journal, *transport, options);
  ASSERT_TRUE(service.start());
  auto client = *Client::connect(
      {.source = "test", .robot = "robot", .spool = folder.path() / "spool"},
      [&](Link::Identity identity) { return network.make_link(std::move(identity)); });
  auto steps = test::drive(3);
  for (double& number : steps.back().factors.front().numbers) number *= 1e200;  // chi2 overflows
  for (const Transaction& step : steps) {
    const auto receipt = client.submit(step, 10s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    ASSERT_FALSE(receipt->refusal) << receipt->reason;
  }
  for (int i = 0; i < 1000 && failures == 0; ++i) std::this_thread::sleep_for(10ms);
  std::this_thread::sleep_for(300ms);  // many pauses of the input
  EXPECT_EQ(failures, 1);
  const auto settled = client.command("settle", 10s);
  ASSERT_FALSE(settled);
  EXPECT_EQ(settled.error().code, ErrorCode::kNotUsable);
  EXPECT_THAT(settled.error().message, testing::HasSubstr("the map cannot be settled ("));
  EXPECT_EQ(failures, 2);
}

}  // namespace
}  // namespace cairn
