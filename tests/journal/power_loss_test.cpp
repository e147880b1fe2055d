// SPDX-License-Identifier: BSD-3-Clause
// kill -9 does not test fsync: what a process wrote, the kernel still writes. Here the power goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>

#include "tests/journal/recorded_disk.hpp"
#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using test::DiskEvent;

constexpr std::uint64_t kRecords = 1500;

struct Acknowledgment {
  std::size_t events = 0;  // that had happened when append() returned
  std::uint64_t number = 0;
};

struct Recording {
  std::vector<DiskEvent> events;
  std::vector<Acknowledgment> acknowledged;
};

// Appends in groups of random sizes, with tables, merges, payloads, snapshots and restarts between.
Recording record(const std::string& root, bool syncs_do_nothing, std::mt19937& random) {
  const auto disk = std::make_shared<test::RecordingFileSystem>(syncs_do_nothing);
  JournalOptions options;
  options.file_system = disk;
  options.write_buffer_bytes = 64u << 10;
  Recording recording;
  std::uint64_t next = 1;
  while (next <= kRecords) {
    const auto journal = test::open_journal(root, options);
    EXPECT_FALSE(journal->open_report().damage);
    for (const std::uint64_t restart = next + kRecords / 6; next < restart && next <= kRecords;) {
      const std::uint64_t last = std::min(kRecords, next + random() % 80);
      const auto revision = journal->append(test::some_records(next, last));
      EXPECT_TRUE(revision) << revision.error().to_string();
      recording.acknowledged.push_back({disk->event_count(), last});
      next = last + 1;
      if (random() % 5 == 0) (void)journal->put_payload(std::string(random() % 9000, 'p'));
      if (random() % 9 == 0) {
        EXPECT_TRUE(journal->write_snapshot(last, "estimates"));
      }
    }
  }
  recording.events = disk->events();
  return recording;
}

struct Outcome {
  int points = 0;
  int lost = 0;    // points at which an acknowledged record was not there
  int alarms = 0;  // points at which damage was reported
  std::string first_trouble;
};

// Is everything that was acknowledged before the power went still there?
void judge(const std::string& folder, std::uint64_t acknowledged, std::size_t point,
           const std::vector<ContentHash>& chain, Outcome& outcome) {
  JournalOptions options;
  options.file_system = test::unsynced_file_system();
  const auto journal = Journal::open(folder, options);
  ++outcome.points;
  std::string trouble;
  std::uint64_t number = 0;
  if (!journal) {
    trouble = journal.error().to_string();
  } else {
    number = (*journal)->head().revision.number;
    if (const auto& damage = (*journal)->open_report().damage) {
      ++outcome.alarms;
      trouble = damage->what;
    }
  }
  const bool kept = journal && number >= acknowledged && (*journal)->head().chain == chain[number];
  outcome.lost += !kept;
  if (!trouble.empty() && outcome.first_trouble.empty())
    outcome.first_trouble = "event " + std::to_string(point) + ": " + trouble;
}

Outcome lose_power(int points, bool syncs_do_nothing, unsigned seed) {
  std::mt19937 random(seed);
  test::TemporaryFolder folder;
  const std::string root = folder.file("data");
  const Recording recording = record(root, syncs_do_nothing, random);
  const std::vector<ContentHash> chain = test::some_chain(kRecords);
  std::vector<std::size_t> at;
  for (int i = 0; i < points; ++i) at.push_back(random() % (recording.events.size() + 1));
  std::sort(at.begin(), at.end());
  test::DiskModel disk;
  std::size_t applied = 0;
  Outcome outcome;
  for (const std::size_t point : at) {
    for (; applied < point; ++applied) disk.apply(recording.events[applied]);
    std::uint64_t acknowledged = 0;
    for (const Acknowledgment& a : recording.acknowledged) {
      if (a.events <= point) acknowledged = a.number;
    }
    const std::string after = folder.file("after");
    disk.write_after_power_loss(root, after, random);
    judge(after, acknowledged, point, chain, outcome);
    std::filesystem::remove_all(after);
  }
  return outcome;
}

unsigned seed() {
  const char* given = std::getenv("CAIRN_TEST_SEED");
  const unsigned seed = given ? static_cast<unsigned>(std::atoi(given)) : std::random_device()();
  std::cout << "seed " << seed << " (CAIRN_TEST_SEED repeats it)\n";
  return seed;
}

TEST(PowerLoss, LosesNothingThatWasAcknowledged) {
  const Outcome outcome = lose_power(500, false, seed());
  EXPECT_EQ(outcome.points, 500);
  EXPECT_EQ(outcome.lost, 0) << outcome.first_trouble;
  // A torn last write is no damage, and nobody should be told that it is.
  EXPECT_EQ(outcome.alarms, 0) << outcome.first_trouble;
}

TEST(PowerLoss, IsFeltWhenSyncsDoNothing) {
  const Outcome outcome = lose_power(50, true, seed());
  EXPECT_GT(outcome.lost, 0) << "this test would not notice a missing fsync";
}

}  // namespace
}  // namespace cairn
