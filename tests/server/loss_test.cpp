// SPDX-License-Identifier: BSD-3-Clause
// What a power failure or a broken disk leaves of a daemon's journal with verdicts, solves and
// orders in it: nothing that was answered or shown is missing, and all of it is executed again
// alike.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>

#include "cairn/history/apply_record.hpp"
#include "cairn/history/order.hpp"
#include "server/reexecution.hpp"
#include "server/replay_journal.hpp"
#include "tests/journal/recorded_disk.hpp"
#include "tests/server/live_service.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

std::uint64_t draw_seed() {
  const char* given = std::getenv("CAIRN_TEST_SEED");
  const std::uint64_t seed = given ? std::strtoull(given, nullptr, 10) : std::random_device()();
  std::cout << "seed " << seed << " (CAIRN_TEST_SEED repeats it)\n";
  return seed;
}

// Its records, and the chain after each.
struct Written {
  std::vector<RecordBody> bodies;
  std::vector<ContentHash> chain{1};

  explicit Written(const Journal& journal) {
    EXPECT_TRUE(journal.for_each(1, [&](const Record& record) -> Result<void> {
      bodies.push_back(record.body);
      chain.push_back(
          chain_in(encode_record(record.number, record.era, record.body, chain.back())));
      return {};
    }));
  }
};

class Loss : public test::LiveService {
 protected:
  Loss() : Loss(std::make_shared<test::RecordingFileSystem>(false)) {}

  // A drive with false loops; orders, their undoing, and solves, live and settled.
  void drive() {
    start();
    for (std::uint64_t i = 0; i < 70; ++i) {
      submit(test::troubled_step(test::kLeader, i));
      promised();
      if (i % 10 == 9) {
        ASSERT_TRUE(client_->command("settle", 10s));
      }
      if (i > 20 && i % 7 == 0) give_orders(journal_->head().revision.number);
    }
    ASSERT_TRUE(client_->command("settle", 10s));
    promised();
    client_.reset();
    ASSERT_TRUE(service_->stop());
    EXPECT_FALSE(events("loop_quarantined").empty());
  }

  // Whether what is left of a journal is all that was promised before the event, and sound.
  void judge(const std::string& folder, std::size_t event, const Written& before) {
    JournalOptions options;
    options.file_system = test::unsynced_file_system();
    const auto journal = Journal::open(folder, options);
    ASSERT_TRUE(journal) << journal.error().to_string();
    if (const auto& damage = (*journal)->open_report().damage) ADD_FAILURE() << damage->what;
    std::uint64_t promised = 0;
    for (const auto& [at, number] : promises_)
      if (at <= event) promised = number;
    const JournalHead head = (*journal)->head();
    EXPECT_GE(head.revision.number, promised);
    ASSERT_LT(head.revision.number, before.chain.size());
    EXPECT_EQ(head.chain, before.chain[head.revision.number]);
    expect_sound(**journal);
  }

  static void expect_sound(const Journal& journal) {
    MapHead head;
    Sequencer sequencer;
    const auto replayed = replay_journal(journal, head, sequencer);
    ASSERT_TRUE(replayed) << replayed.error().to_string();
    const auto executed = Reexecution(journal).run();
    ASSERT_TRUE(executed) << executed.error().to_string();
    EXPECT_EQ(executed->solves_compared + executed->solves_skipped, 0u);
  }

  // Served again, it settles, and all of it is executed again alike.
  static void expect_goes_on(Journal& journal) {
    MemoryNetwork network;
    const auto transport = network.make_transport();
    Service service(journal, *transport, {.solve_after_pause = 1ms});
    const auto started = service.start();
    ASSERT_TRUE(started) << started.error().to_string();
    Client client = *Client::connect(ClientOptions{}, [&](Link::Identity identity) {
      return network.make_link(std::move(identity));
    });
    const auto settled = client.command("settle", 10s);
    EXPECT_TRUE(settled) << settled.error().to_string();
    ASSERT_TRUE(service.stop());
    expect_sound(journal);
  }

  // All that was ever said is in the journal by then.
  void promised() {
    promises_.emplace_back(disk_->event_count(), journal_->head().revision.number);
  }

  std::shared_ptr<test::RecordingFileSystem> disk_;
  std::vector<std::pair<std::size_t, std::uint64_t>> promises_;  ///< (events, record)

 private:
  explicit Loss(std::shared_ptr<test::RecordingFileSystem> disk)
      : LiveService({.file_system = disk, .write_buffer_bytes = 64u << 10}),
        disk_(std::move(disk)) {}

  void give_orders(std::uint64_t record) {
    Question off{"edge disable"};
    off.options["factors"] = std::vector<std::string>{std::to_string(record / 2)};
    Question undo{"undo", {{"record", record - 8}, {"cascade", true}}};
    for (const Question& question : {off, undo}) {
      const auto answer = client_->command(question.to_string(), 10s);
      promised();
      const std::size_t at = answer ? answer->rfind("record ") : std::string::npos;
      if (at == std::string::npos) continue;  // that record was none
      ASSERT_TRUE(client_->command("undo {\"record\":" + answer->substr(at + 7) + '}', 10s));
      promised();
    }
  }
};

TEST_F(Loss, OfPowerLosesNothingThatWasSaid) {
  drive();
  const Written before(*journal_);
  service_.reset();
  journal_.reset();
  std::mt19937 random(static_cast<unsigned>(draw_seed()));
  const std::vector<test::DiskEvent> events = disk_->events();
  std::vector<std::size_t> at;
  for (int i = 0; i < 100; ++i) at.push_back(random() % (events.size() + 1));
  std::sort(at.begin(), at.end());
  test::DiskModel disk;
  std::size_t applied = 0;
  for (const std::size_t point : at) {
    SCOPED_TRACE("event " + std::to_string(point));
    for (; applied < point; ++applied) disk.apply(events[applied]);
    const std::string after = folder_.file("after");
    disk.write_after_power_loss(folder_.file("data"), after, random);
    judge(after, point, before);
    std::filesystem::remove_all(after);
  }
}

// Damage leaves any beginning: also verdicts without the solve that found them.
TEST_F(Loss, OfTheEndLeavesAJournalThatGoesOn) {
  drive();
  const Written before(*journal_);
  int cut_in_verdicts = 0;
  for (std::size_t kept = 1; kept < before.bodies.size(); ++kept) {
    const bool in_verdicts = std::holds_alternative<VerdictRecord>(before.bodies[kept - 1]);
    if (!in_verdicts && kept % 40 != 0) continue;
    if (in_verdicts && ++cut_in_verdicts % 4 != 0) continue;
    SCOPED_TRACE("after record " + std::to_string(kept));
    const test::TemporaryFolder folder;
    JournalOptions options;
    options.file_system = test::unsynced_file_system();
    const auto journal = *Journal::open(folder.file("data"), options);
    ASSERT_TRUE(journal->append(std::span(before.bodies).first(kept)));
    ASSERT_TRUE(journal->raise_era());
    expect_goes_on(*journal);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(cut_in_verdicts, 4);
}

// Bits that have turned, anywhere in the store.
TEST_F(Loss, OfBitsLeavesAJournalThatGoesOn) {
  drive();
  const Written before(*journal_);
  service_.reset();
  journal_.reset();
  std::mt19937_64 random(draw_seed());
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "data" / "store"))
    if (entry.file_size() > 0) files.push_back(entry.path().filename());
  std::sort(files.begin(), files.end());
  int damaged = 0;
  for (int i = 0; i < 12 && !HasFatalFailure(); ++i) {
    const std::string& file = files[random() % files.size()];
    const std::filesystem::path copy = folder_.path() / "copy", flawed = copy / "store" / file;
    std::filesystem::copy(folder_.path() / "data", copy, std::filesystem::copy_options::recursive);
    std::string bytes = test::read_file(flawed);
    bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
    std::ofstream(flawed, std::ios::binary) << bytes;
    SCOPED_TRACE(file);
    JournalOptions options;
    options.file_system = test::unsynced_file_system();
    const auto journal = Journal::open(copy, options);
    ASSERT_TRUE(journal) << journal.error().to_string();
    const JournalHead head = (*journal)->head();
    damaged += (*journal)->open_report().damage.has_value();
    ASSERT_LT(head.revision.number, before.chain.size());
    EXPECT_EQ(head.chain, before.chain[head.revision.number]);
    expect_goes_on(**journal);
    std::filesystem::remove_all(copy);
  }
  EXPECT_GT(damaged, 0);
}

}  // namespace
}  // namespace cairn
