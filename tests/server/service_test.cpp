// SPDX-License-Identifier: BSD-3-Clause
#include "server/service.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::drive;
using test::estimates;

// How much of the disk is free, %, as tests like it.
struct Disk {
  std::atomic<unsigned> free{50};

  JournalOptions options() {
    return {.measure_space = [this](const std::string&) {
      return std::filesystem::space_info{100, free, free};
    }};
  }
};

// A daemon on a folder and an in-memory network, and a client of it.
struct Station {
  explicit Station(const std::filesystem::path& folder, const JournalOptions& options = {})
      : journal(*Journal::open((folder / "data").string(), options)),
        transport(network.make_transport()),
        service(*journal, *transport, {.solve_after_pause = 20ms, .state_every = 10ms}),
        client(connect(folder / "spool")) {
    EXPECT_TRUE(service.start());
  }
  Client connect(const std::filesystem::path& spool) {
    return *Client::connect(
        {.source = "test", .robot = "robot", .spool = spool, .retry_most = 50ms},
        [this](Link::Identity identity) { return network.make_link(std::move(identity)); });
  }

  MemoryNetwork network;
  std::unique_ptr<Journal> journal;
  std::unique_ptr<Transport> transport;
  Service service;
  Client client;
};

TEST(Service, ReceiptsSolvesAndPublishesWhatAClientSends) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  Receipt last;
  for (const Transaction& step : drive(60)) {
    const Result<Receipt> receipt = station.client.submit(step, 10s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    ASSERT_FALSE(receipt->refusal) << receipt->reason;
    last = *receipt;
  }
  EXPECT_GE(last.revision.number, 60U);  // solves are records too
  ASSERT_TRUE(station.client.wait_for(last.revision, 10s));
  ASSERT_TRUE(station.client.wait_solved(last.revision, 30s));
  const Result<std::string> settled = station.client.command("settle", 30s);
  ASSERT_TRUE(settled) << settled.error().to_string();
  EXPECT_TRUE(settled->starts_with("settled at ")) << *settled;

  EXPECT_EQ(estimates(*station.journal), test::settled_estimates(drive(60)));
}

TEST(Service, GoesOnWhereItWasAfterARestart) {
  const test::TemporaryFolder folder;
  const std::vector<Transaction> steps = drive(40);
  std::vector<double> before;
  JournalHead head_before;
  {
    Station station(folder.path());
    for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(station.client.submit(steps[i], 10s));
    ASSERT_TRUE(station.client.command("settle", 30s));
    station.service.stop();
    before = estimates(*station.journal);
    head_before = station.journal->head();
  }
  Station station(folder.path());
  EXPECT_EQ(station.journal->head(), head_before);
  EXPECT_EQ(estimates(*station.journal), before);
  for (std::size_t i = 20; i < 40; ++i) {
    const Result<Receipt> receipt = station.client.submit(steps[i], 10s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
    EXPECT_EQ(receipt->key.sequence, i + 1);  // the spool goes on
  }
  EXPECT_TRUE(station.journal->verify());
}

// Estimates come from the snapshot that the first station left, and are those of a full replay.
TEST(Service, StartsFromItsSnapshotAndTheRecordsBehindIt) {
  const test::TemporaryFolder folder;
  const std::vector<Transaction> steps = drive(30);
  {
    Station station(folder.path());
    for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(station.client.submit(steps[i], 10s));
    ASSERT_TRUE(station.client.command("settle", 30s));
    station.service.stop();
    ASSERT_TRUE(station.journal->newest_snapshot());
    EXPECT_EQ(station.journal->newest_snapshot()->number, station.journal->head().revision.number);
    MapHead head;
    Sequencer sequencer;
    const auto replayed = replay_journal(*station.journal, head, sequencer);
    ASSERT_TRUE(replayed);
    EXPECT_TRUE(replayed->chi2);  // nothing to solve
  }
  Station station(folder.path());
  for (std::size_t i = 20; i < 30; ++i) ASSERT_TRUE(station.client.submit(steps[i], 10s));
  station.service.stop();  // no solve comes after it
  const std::vector<double> with_snapshot = estimates(*station.journal);
  std::filesystem::remove_all(folder.path() / "data" / "snapshots");
  EXPECT_EQ(estimates(*station.journal), with_snapshot);
}

// T_map_odom is where the newest keyframe is in the map, seen from where odometry thinks it is.
TEST(Service, TellsRobotsWhereTheirOdometryFrameLies) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  std::mutex mutex;
  std::vector<Correction> corrections;
  station.client.on_corrections([&](const Correction& correction) {
    const std::lock_guard lock(mutex);
    corrections.push_back(correction);
  });
  std::vector<Transaction> steps = drive(30);
  Receipt last;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].variables[0].odometry = {static_cast<double>(i), 1.0, 0.0};
    steps[i].variables[0].stamp_ns = static_cast<std::int64_t>(i);
    const auto receipt = station.client.submit(steps[i], 10s);
    ASSERT_TRUE(receipt);
    last = *receipt;
  }
  ASSERT_TRUE(station.client.wait_solved(last.revision, 30s));
  ASSERT_TRUE(station.client.command("settle", 30s));
  const std::vector<double> all = estimates(*station.journal);
  const double* newest = all.data() + 7 * 29;
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < deadline) {
    const std::lock_guard lock(mutex);
    if (corrections.empty() || corrections.back().stamp_ns != 29) continue;
    const Correction& c = corrections.back();
    if (c.revisions.solved.number < last.revision.number) continue;
    const double x = c.T_map_odom[0] + std::cos(c.T_map_odom[2]) * 29.0 - std::sin(c.T_map_odom[2]);
    const double y = c.T_map_odom[1] + std::sin(c.T_map_odom[2]) * 29.0 + std::cos(c.T_map_odom[2]);
    EXPECT_NEAR(x, newest[0], 1e-9);
    EXPECT_NEAR(y, newest[1], 1e-9);
    EXPECT_NEAR(c.T_map_odom[2], newest[2], 1e-9);
    EXPECT_GT(c.jump_m, 0.0);  // the solve moved the robot
    return;
  }
  FAIL() << "no correction of the last keyframe came";
}

TEST(Service, TakesNothingOnAFullDiskAndGoesOnByItself) {
  const test::TemporaryFolder folder;
  Disk disk;
  Station station(folder.path(), disk.options());
  const std::vector<Transaction> steps = drive(3);
  ASSERT_TRUE(station.client.submit(steps[0], 10s));
  disk.free = 1;
  const auto wait_for_state = [&](DiskSpace expected) {
    while (station.journal->space() != expected) std::this_thread::yield();
    std::this_thread::sleep_for(1200ms);  // it looks once a second
  };
  wait_for_state(DiskSpace::kFull);
  const std::uint64_t before = station.journal->head().revision.number;
  const auto waiting = station.client.submit_async(steps[1]);
  ASSERT_TRUE(waiting);
  EXPECT_FALSE(waiting->wait(300ms));
  EXPECT_EQ(station.journal->head().revision.number, before);
  disk.free = 50;
  const Result<Receipt> receipt = waiting->wait(20s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_FALSE(receipt->refusal) << receipt->reason;
  EXPECT_EQ(receipt->key.sequence, 2U);
}

TEST(Service, HandsAFinalRefusalToTheCallerAndKeepsTheMap) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  Transaction unknown = drive(2)[1];  // ties to pose 0, which is not there
  const Result<Receipt> receipt = station.client.submit(unknown, 10s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(receipt->refusal, RefusalCode::kUnknownVariable);
  EXPECT_EQ(receipt->reason, "factor 0: the node robot/3/0 is not known");
  EXPECT_TRUE(estimates(*station.journal).empty());
  const Result<std::string> reply = station.client.command("dance", 10s);
  ASSERT_FALSE(reply);
  EXPECT_TRUE(reply.error().message.starts_with("unknown command 'dance'; known: status, "));
}

// A copy of a spool, as a program has that starts again before the lease of its last run has ended.
// Files of a living client's spool come and go.
void copy_while_used(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code failed;
  for (int tries = 0; tries < 100; ++tries) {
    std::filesystem::remove_all(to);
    std::filesystem::copy(from, to, failed);
    if (!failed) return;
    std::this_thread::sleep_for(10ms);
  }
  FAIL() << failed.message();
}

TEST(Service, LetsASecondWriterOfTheSameSpoolWaitForTheEndOfTheFirst) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  const std::vector<Transaction> steps = drive(10);
  for (std::size_t i = 0; i < 5; ++i) ASSERT_TRUE(station.client.submit(steps[i], 10s));
  copy_while_used(folder.path() / "spool", folder.path() / "copy");
  Client second = station.connect(folder.path() / "copy");
  const Submission waiting = *second.submit_async(steps[5]);
  EXPECT_FALSE(waiting.wait(200ms));
  { const Client end = std::move(station.client); }
  const Result<Receipt> receipt = waiting.wait(10s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_FALSE(receipt->refusal) << receipt->reason;
  EXPECT_EQ(receipt->key.sequence, 6U);
}

TEST(Service, LetsAnotherProgramUnderALivingSourcesNameWaitForItsEnd) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  const std::vector<Transaction> steps = drive(10);
  ASSERT_TRUE(station.client.submit(steps[0], 10s));
  Client other = station.connect(folder.path() / "other");
  std::promise<std::string> trouble;  // a second one would throw
  other.on_trouble([&](const Error& error) { trouble.set_value(error.message); });
  const Submission waiting = *other.submit_async(steps[2]);
  EXPECT_TRUE(trouble.get_future().get().starts_with("another program lives under this source"));
  EXPECT_FALSE(waiting.wait(200ms));
  EXPECT_FALSE(station.client.submit(steps[1], 10s)->refusal);  // it disturbed nobody
  { const Client end = std::move(station.client); }
  const Result<Receipt> receipt = waiting.wait(10s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_FALSE(receipt->refusal) << receipt->reason;
}

TEST(Service, TellsItsStateAndThatOfItsSources) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  std::mutex mutex;
  std::condition_variable changed;
  Status status;
  Client watcher = *Client::connect(
      {}, [&](Link::Identity identity) { return station.network.make_link(std::move(identity)); });
  watcher.on_status([&](const Status& now) {
    const std::lock_guard lock(mutex);
    status = now;
    changed.notify_all();
  });
  const auto wait = [&](const std::function<bool()>& condition) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, 10s, condition);
  };
  const std::vector<Transaction> steps = drive(2);
  ASSERT_TRUE(station.client.submit(steps[0], 10s));
  ASSERT_TRUE(station.client.submit(steps[0], 10s)->refusal);  // the node is there
  EXPECT_TRUE(wait([&] { return status.sources.size() == 1 && status.sources[0].refused == 1; }));
  EXPECT_EQ(status.sources[0].accepted, 1U);
  EXPECT_TRUE(status.sources[0].alive);
  EXPECT_EQ(status.sources[0].refused_by_code.at(0).first, RefusalCode::kConflict);
  EXPECT_LE(status.sources[0].clock_offset_ns, 0);  // the same clock, and some delay
  EXPECT_GT(status.sources[0].clock_offset_ns, -10'000'000'000);
  { const Client end = std::move(station.client); }
  EXPECT_TRUE(wait([&] { return !status.sources[0].alive; }));
}

}  // namespace
}  // namespace cairn
