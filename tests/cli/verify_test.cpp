// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cairn/replay/estimate_snapshot.hpp"
#include "tests/cli/data_folder.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace cairn::test;
using testing::HasSubstr;

class Verify : public testing::Test {
 protected:
  [[nodiscard]] std::string data() const { return folder_.file("data"); }
  [[nodiscard]] ProcessResult run(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"verify", "--data", data()});
    return run_cairn(more);
  }

  TemporaryFolder folder_;
};

TEST_F(Verify, ExecutesEverythingAgainAndComparesBits) {
  {
    DataFolderMaker maker(data());
    maker.submit_all(drive(40));
    maker.solve();
    maker.submit(impossible_step());
    maker.submit(drive(41).back());
    maker.append(CommandRecord{"anna", "why not", "settle", 0});
    maker.solve();
  }
  const auto verified = run({"--json", "--at", "12"});
  ASSERT_EQ(verified.exit_code, 0) << verified.err;
  const auto json = nlohmann::json::parse(verified.out);
  EXPECT_EQ(json["records"], 79);
  EXPECT_EQ(json["accepted"], 41);
  EXPECT_EQ(json["refused"], 1);
  EXPECT_EQ(json["commands"], 1);
  EXPECT_EQ(json["verdicts"], 34) << "one for each loop";
  EXPECT_EQ(json["solves"]["same_bits"], 2);
  EXPECT_EQ(json["head_hash_at"]["number"], 12);
  EXPECT_THAT(run().out, HasSubstr(std::string(json["head_hash"])));
}

TEST_F(Verify, HashesOfTwoJournalsOfTheSameRunAreTheSameAtEveryRevision) {
  const auto hashes_of = [&](const std::string& name, double last_x) {
    {
      DataFolderMaker maker(folder_.file(name));
      auto steps = drive(20);
      steps.back().variables.front().start.front() += last_x;
      maker.submit_all(steps);
      maker.solve();
    }
    const auto verified =
        run_cairn({"verify", "--data", folder_.file(name), "--hashes", folder_.file("csv"), "-q"});
    EXPECT_EQ(verified.exit_code, 0) << verified.err;
    EXPECT_EQ(verified.out, "");
    std::vector<std::string> heads;
    std::ifstream file(folder_.file("csv"));
    for (std::string line; std::getline(file, line);)
      heads.push_back(line.substr(0, line.rfind(',')));
    return heads;
  };
  const auto one = hashes_of("one", 0.0), two = hashes_of("two", 0.0), other = hashes_of("b", 0.1);
  ASSERT_EQ(one.size(), 34u) << "20 transactions, 13 verdicts, a solve";
  EXPECT_THAT(one.back(), HasSubstr("34,0,solve,"));
  EXPECT_EQ(one, two);
  EXPECT_EQ(one[18], other[18]);
  EXPECT_NE(one[19], other[19]);
}

TEST_F(Verify, FindsASolveThatComesOutOtherwise) {
  {
    DataFolderMaker maker(data());
    maker.submit_all(drive(20));
    maker.solve([](SolveRecord& record) { record.changed.back().numbers.front() += 1e-6; });
  }
  const auto verified = run();
  EXPECT_EQ(verified.exit_code, 3);
  EXPECT_THAT(verified.err, HasSubstr("record 34: solved again, robot/3/"));
}

TEST_F(Verify, FindsAVerdictThatTheGateDoesNotGive) {
  {
    DataFolderMaker maker(data());
    maker.submit_all(drive(20));
    maker.append(VerdictRecord{
        {{"laser", 7, 9}, 1}, "does not fit the map", 512.0, 99.0, {}, FactorState::kQuarantined});
    maker.solve();
  }
  const auto verified = run();
  EXPECT_EQ(verified.exit_code, 3);
  EXPECT_THAT(verified.err,
              HasSubstr("record 35: solved again, the gate finds 13 verdicts, which are not the 14 "
                        "that are recorded before it"));
}

TEST_F(Verify, ComparesSolvesOfOtherMachinesToOneInABillion) {
  {
    DataFolderMaker maker(data());
    maker.submit_all(drive(20));
    maker.solve([&](SolveRecord& record) {
      record.settings =
          SolveSettings{SolveSettings::here().method, "libm of another kind"}.to_string();
      record.changed.back().numbers.front() += 1e-12;
      PoseGraph after = maker.map();
      for (const ChangedEstimate& changed : record.changed)
        std::copy(changed.numbers.begin(), changed.numbers.end(),
                  after.estimates.edit(changed.node.index).begin());
      record.estimates_hash = hash_estimates(after);
    });
  }
  const auto verified = run();
  EXPECT_EQ(verified.exit_code, 0) << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("1 solves not bit-comparable"));
  EXPECT_THAT(verified.out, HasSubstr("libm of another kind"));
}

TEST_F(Verify, FindsADecisionThatCannotBeMade) {
  const auto forged = [&](const std::function<void(TransactionRecord&)>& forge) {
    std::filesystem::remove_all(data());
    {
      DataFolderMaker maker(data());
      maker.submit_all(drive(5));
      Transaction transaction = drive(6).back();
      transaction.key = {"laser", 7, 6};
      TransactionRecord record{transaction, content_hash(encode(transaction)), 0};
      forge(record);
      maker.append(std::move(record));
    }
    const auto verified = run();
    EXPECT_EQ(verified.exit_code, 3) << verified.out;
    return verified.err;
  };
  EXPECT_THAT(forged([](TransactionRecord& record) { record.content_hash[0] ^= 1; }),
              HasSubstr("record 6: transaction laser/6 does not have the hash"));
  EXPECT_THAT(forged([](TransactionRecord& record) {
                auto& transaction = std::get<Transaction>(record.outcome);
                transaction.factors.front().nodes.front().index = 77;
                record.content_hash = content_hash(encode(transaction));
              }),
              HasSubstr("executed again it is refused"));
  EXPECT_THAT(forged([](TransactionRecord& record) {
                auto& transaction = std::get<Transaction>(record.outcome);
                transaction.key.sequence = 5;
                record.content_hash = content_hash(encode(transaction));
              }),
              HasSubstr("executed again it is not decided: sequence 5 was decided with other"));
}

TEST_F(Verify, ComparesTheStoredEstimatesWithTheRecords) {
  const auto store = [&](double off) {
    std::filesystem::remove_all(data());
    DataFolderMaker(data()).submit_all(drive(20));
    MapHead head;
    Sequencer sequencer;
    const auto journal = *Journal::open(data());
    ASSERT_TRUE(replay_journal(*journal, head, sequencer));
    PoseGraph map = head.graph();
    map.estimates.edit(3)[0] += off;
    ASSERT_TRUE(journal->write_snapshot(20, encode_snapshot(map, 0.0)));
  };
  store(0.0);
  EXPECT_THAT(run().out, HasSubstr("the estimates stored after record 20 are those"));
  store(1e-6);
  EXPECT_EQ(run().exit_code, 3);
  EXPECT_THAT(run().err, HasSubstr("record 20: the estimates stored after it"));
}

TEST_F(Verify, TellsOfSequencesThatNobodyHasAnyMore) {
  {
    DataFolderMaker maker(data());
    maker.submit_all(drive(5));
    Transaction transaction = drive(6).back();
    transaction.key = {"laser", 7, 9};
    maker.append(TransactionRecord{transaction, content_hash(encode(transaction)), 0});
  }
  const auto verified = run();
  EXPECT_EQ(verified.exit_code, 0) << verified.err;
  EXPECT_THAT(verified.err, HasSubstr("record 6: sequences 6 to 8 of laser are missing"));
}

TEST_F(Verify, LeavesADamagedFolderAsItIs) {
  DataFolderMaker(data()).submit_all(drive(30));
  std::string log;
  for (const auto& entry : std::filesystem::directory_iterator(data() + "/store")) {
    if (entry.path().extension() == ".log" && entry.file_size() > 0) log = entry.path().string();
  }
  std::string bytes = read_file(log);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  std::ofstream(log, std::ios::binary) << bytes;
  const auto verified = run();
  EXPECT_EQ(verified.exit_code, 3);
  EXPECT_THAT(verified.err, HasSubstr("damaged: " + log + ", byte "));
  EXPECT_THAT(verified.err, HasSubstr("nothing was changed"));
  EXPECT_EQ(read_file(log), bytes);
  EXPECT_EQ(run().err, verified.err);
}

TEST_F(Verify, SaysWhatItNeeds) {
  EXPECT_THAT(run().err, HasSubstr("there is no journal here; expected a data folder of cairnd"));
  EXPECT_EQ(run().exit_code, 3);
  DataFolderMaker maker(data());
  const auto used = run();
  EXPECT_EQ(used.exit_code, 2);
  EXPECT_THAT(used.err, HasSubstr("in use by process " + std::to_string(getpid())));
  EXPECT_EQ(run_cairn({"verify"}).exit_code, 2);
}

TEST_F(Verify, AsksForARevisionThatExists) {
  DataFolderMaker(data()).submit_all(drive(3));
  const auto verified = run({"--at", "4"});
  EXPECT_EQ(verified.exit_code, 2);
  EXPECT_THAT(verified.err, HasSubstr("records 1 to 3"));
}

}  // namespace
