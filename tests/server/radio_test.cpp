// SPDX-License-Identifier: BSD-3-Clause
// The daemon as a process and a client here, in datagrams of 1400 bytes over a link that loses one
// datagram in ten in each direction, and everything for ten seconds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <future>
#include <iostream>
#include <thread>

#include "clients/client/client.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// The shipped radio configuration on the loopback interface, which is the only one in CI, with
// loss.
std::string lossy_radio() {
  std::string text = test::read_file(CAIRN_SOURCE_DIR "/idl/cyclonedds-radio.xml");
  const auto put = [&](const std::string& where, const std::string& what) {
    const std::size_t at = text.find(where);
    if (at == std::string::npos) std::abort();
    text.replace(at, where.size(), what);
  };
  put("<AllowMulticast>spdp</AllowMulticast>",
      "<Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
      "<AllowMulticast>false</AllowMulticast>");
  put("<Discovery>", "<Discovery><Peers><Peer Address='127.0.0.1'/></Peers>");
  put("<Internal>", "<Internal><Test><XmitLossiness>100</XmitLossiness></Test>");
  return text;
}

struct Sent {
  Submission submission;
  Clock::time_point at;
};

Sent send(Client& client, std::uint64_t step) {
  const auto at = Clock::now();
  return {*client.submit_async(test::troubled_step(test::kLeader, step)), at};
}

// Latencies of the receipts, ms, ascending.
std::vector<double> await(const std::vector<Sent>& all) {
  std::vector<double> latencies;
  for (const Sent& sent : all) {
    const Result<Receipt> receipt = sent.submission.wait(60s);
    EXPECT_TRUE(receipt) << receipt.error().to_string();
    if (!receipt) break;
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
    latencies.push_back(1e3 * std::chrono::duration<double>(Clock::now() - sent.at).count());
  }
  std::sort(latencies.begin(), latencies.end());
  return latencies;
}

TEST(Radio, LosesNothingAtTenPercentLossAndThroughAnOutage) {
  setenv("CYCLONEDDS_URI", lossy_radio().c_str(), 1);
  const test::TemporaryFolder folder;
  const std::uint32_t domain = test::own_domain();
  const std::string data = folder.path() / "data";
  test::Process daemon({CAIRND_BINARY, "--data", data, "--domain", std::to_string(domain)});
  constexpr std::uint64_t kBefore = 200, kDuring = 100, kAfter = 50;
  {
    Result<Client> client = Client::connect({.domain = domain,
                                             .source = test::kLeader,
                                             .robot = test::kLeader,
                                             .spool = folder.path() / "spool"});
    ASSERT_TRUE(client) << client.error().to_string();
    ASSERT_TRUE(send(*client, 0).submission.wait(30s));
    std::vector<std::future<std::vector<double>>> lossy;
    for (std::uint64_t step = 1; step < kBefore; ++step) {
      lossy.push_back(std::async(std::launch::async, await, std::vector{send(*client, step)}));
      std::this_thread::sleep_for(10ms);
    }
    std::vector<double> with_loss;
    for (auto& latency : lossy) {
      for (const double milliseconds : latency.get()) with_loss.push_back(milliseconds);
    }
    std::sort(with_loss.begin(), with_loss.end());
    ASSERT_EQ(with_loss.size(), kBefore - 1);

    // Nothing gets through, in either direction.
    ASSERT_TRUE(dds::cut_link(domain, 10s));
    const auto outage = Clock::now();
    std::vector<Sent> cut_off;
    for (std::uint64_t step = kBefore; step < kBefore + kDuring; ++step) {
      cut_off.push_back(send(*client, step));
      std::this_thread::sleep_for(50ms);
    }
    EXPECT_FALSE(cut_off.front().submission.wait(1ms)) << "the link was not cut";
    ASSERT_EQ(await(cut_off).size(), kDuring);
    const double back = std::chrono::duration<double>(Clock::now() - outage).count() - 10.0;
    std::vector<Sent> late;
    for (std::uint64_t step = kBefore + kDuring; step < kBefore + kDuring + kAfter; ++step)
      late.push_back(send(*client, step));
    ASSERT_EQ(await(late).size(), kAfter);
    std::cout << "receipts at 10 % loss: p50 " << with_loss[with_loss.size() / 2] << " ms, p99 "
              << with_loss[with_loss.size() * 99 / 100] << " ms; all that was submitted in the "
              << "outage is durable " << back << " s after it\n";
    ASSERT_TRUE(client->command("settle", 60s));
  }
  EXPECT_EQ(daemon.end(SIGTERM).exit_code, 0);
  const auto journal = Journal::open(data);
  ASSERT_TRUE(journal);
  EXPECT_EQ(test::estimates(**journal),
            test::settled_estimates(test::troubled_drive(kBefore + kDuring + kAfter)));
}

}  // namespace
}  // namespace cairn
