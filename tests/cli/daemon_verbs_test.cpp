// SPDX-License-Identifier: BSD-3-Clause
// The verbs that ask a running daemon: the real programs over real DDS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/io/graph_file.hpp"
#include "clients/client/client.hpp"
#include "tests/support/datasets.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::string own_domain() { return std::to_string(cairn::test::own_domain()); }

// A daemon of its own for each test, and what is asked of it.
class DaemonVerbs : public testing::Test {
 protected:
  void start() {
    daemon_ = std::make_unique<Process>(
        std::vector<std::string>{CAIRND_BINARY, "--data", data(), "--domain", own_domain()});
  }
  int stop() {
    daemon_->send(SIGTERM);
    const int code = daemon_->wait().exit_code;
    daemon_.reset();
    return code;
  }
  [[nodiscard]] std::string data() const { return folder_.file("data"); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] static ProcessResult ask(std::vector<std::string> words) {
    words.insert(words.end(), {"--domain", own_domain(), "--timeout", "20"});
    return run_cairn(words);
  }
  [[nodiscard]] ProcessResult ask_folder(std::vector<std::string> words) const {
    words.insert(words.end(), {"--data", data()});
    return run_cairn(words);
  }
  [[nodiscard]] ProcessResult replay(std::vector<std::string> words) const {
    words.insert(words.begin(), "replay");
    words.insert(words.end(), {"--spool", folder_.file("spool"), "--settle"});
    return ask(words);
  }

  TemporaryFolder folder_;
  std::unique_ptr<Process> daemon_;
};

double chi2_in(const std::string& settled) {
  const auto at = settled.find("chi2 ");
  return at == std::string::npos ? NAN : std::stod(settled.substr(at + 5));
}

TEST_F(DaemonVerbs, AnswersOfDaemonAndFolderAreTheSame) {
  ASSERT_EQ(run_cairn({"simulate", "grid", "--poses", "120", "-o", file("grid.g2o")}).exit_code, 0);
  start();
  const auto sent = replay({file("grid.g2o")});
  ASSERT_EQ(sent.exit_code, 0) << sent.err;
  EXPECT_THAT(sent.out, HasSubstr("120 transactions are durable"));

  const auto status = ask({"status", "--json"});
  ASSERT_EQ(status.exit_code, 0) << status.err;
  const auto facts = json::parse(status.out);
  EXPECT_EQ(facts["variables"], 120);
  EXPECT_EQ(facts["sources"][0]["source"], "replay-grid");
  EXPECT_EQ(facts["sources"][0]["accepted"], 120);
  EXPECT_GT(facts["memory_bytes"], 1'000'000);
  EXPECT_NEAR(facts["chi2"], chi2_in(sent.out), 1e-6 * chi2_in(sent.out));
  EXPECT_THAT(ask({"status", "--interface", "lo"}).out, HasSubstr("replay-grid"));

  const std::vector<std::vector<std::string>> questions{{"log", "--limit", "0"},
                                                        {"log", "--kind", "solve", "--json"},
                                                        {"show", "120"},
                                                        {"diff", "10", "120", "--json"},
                                                        {"diff", "100", "121"},
                                                        {"export", "graph", "-"},
                                                        {"show", "99999"},
                                                        {"export", "trajectory", "-", "--live"},
                                                        {"settle"}};
  std::vector<ProcessResult> answers;
  for (const auto& question : questions) answers.push_back(ask(question));
  ASSERT_EQ(ask({"backup", file("backups")}).exit_code, 0);
  ASSERT_EQ(stop(), 0);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto told = ask_folder(questions[i]);
    EXPECT_EQ(answers[i].exit_code, told.exit_code) << questions[i][0] << answers[i].err;
    EXPECT_EQ(answers[i].out, told.out) << questions[i][0];
    EXPECT_EQ(answers[i].err, told.err) << questions[i][0];
  }
  EXPECT_EQ(ask_folder({"verify"}).exit_code, 0);
  ASSERT_EQ(run_cairn({"restore", file("backups"), "--data", file("again")}).exit_code, 0);
  EXPECT_EQ(run_cairn({"export", "graph", "-", "--data", file("again")}).out,
            ask_folder({"export", "graph", "-"}).out);
}

// One object per line, until somebody has seen enough.
TEST_F(DaemonVerbs, WatchesTheStatus) {
  ASSERT_EQ(run_cairn({"simulate", "grid", "--poses", "120", "-o", file("grid.g2o")}).exit_code, 0);
  start();
  ASSERT_EQ(replay({file("grid.g2o")}).exit_code, 0);
  Process watching(cairn_command({"status", "--watch", "0.1", "--json", "--domain", own_domain()}));
  // Trust is measured after the map was settled.
  const auto seen_enough = [&] {
    const std::string out = watching.out();
    return out.find("sigma_factor") != std::string::npos &&
           std::count(out.begin(), out.end(), '\n') >= 3;
  };
  for (int i = 0; i < 2000 && !seen_enough(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const ProcessResult seen = watching.end(SIGINT);
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  std::istringstream text(seen.out);
  int count = 0;
  for (std::string line; std::getline(text, line); ++count) {
    const auto status = json::parse(line);
    EXPECT_EQ(status["schema_version"], 1);
    EXPECT_EQ(status["variables"], 120);
    EXPECT_FALSE(status["solver"]["running"].is_null());
    EXPECT_EQ(status["queues"]["inbox_messages"], 0);
    EXPECT_EQ(status["latency"]["receipt"]["count"], 120);
    EXPECT_GT(status["latency"]["receipt"]["p50_ms"], 0.0);
    EXPECT_GE(status["latency"]["receipt"]["max_ms"], status["latency"]["receipt"]["p99_ms"]);
    EXPECT_GT(status["latency"]["closure_to_poses"]["count"], 0);
    EXPECT_EQ(status["sources"][0]["quarantined"], 0);
  }
  EXPECT_GE(count, 3);
  const auto trust = json::parse(ask({"status", "--json"}).out)["trust"];
  ASSERT_EQ(trust.size(), 2u);
  EXPECT_EQ(trust[0]["source"], "replay-grid");
  EXPECT_EQ(trust[0]["robot"], "grid");
  EXPECT_EQ(trust[1]["kind"], "loop");
  EXPECT_NEAR(trust[1]["sigma_factor"].get<double>(), 1.0, 0.3) << "simulated noise is as stated";
  EXPECT_EQ(ask({"status", "--watch", "nonsense"}).exit_code, 2);
  EXPECT_EQ(ask_folder({"status", "--watch"}).exit_code, 2);
  EXPECT_THAT(ask({"status"}).out, HasSubstr("receipts   p50 "));
}

TEST_F(DaemonVerbs, SayWhatToDoWhereNoDaemonAnswers) {
  for (const std::vector<std::string>& verb :
       std::vector<std::vector<std::string>>{{"status"},
                                             {"log"},
                                             {"settle"},
                                             {"export", "graph", file("o.g2o")},
                                             {"backup", file("b")}}) {
    auto words = verb;
    words.insert(words.end(), {"--domain", own_domain(), "--timeout", "0.2"});
    const auto asked = run_cairn(words);
    EXPECT_EQ(asked.exit_code, 5) << verb[0];
    EXPECT_THAT(asked.err, HasSubstr("no daemon answers in domain " + own_domain()));
    EXPECT_THAT(asked.err, HasSubstr("start one (cairnd --data DIR --domain"));
  }
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(DaemonVerbs, RefuseAFolderThatADaemonServes) {
  ASSERT_EQ(run_cairn({"simulate", "grid", "--poses", "10", "-o", file("grid.g2o")}).exit_code, 0);
  start();
  ASSERT_EQ(replay({file("grid.g2o")}).exit_code, 0);
  for (const char* verb : {"status", "log", "settle", "verify"}) {
    const auto asked = ask_folder({verb});
    EXPECT_EQ(asked.exit_code, 2) << verb;
    EXPECT_THAT(asked.err, HasSubstr("in use by process"));
  }
}

TEST_F(DaemonVerbs, ReplayingTwiceSaysWhatToDo) {
  ASSERT_EQ(run_cairn({"simulate", "grid", "--poses", "10", "-o", file("grid.g2o")}).exit_code, 0);
  start();
  ASSERT_EQ(replay({file("grid.g2o")}).exit_code, 0);
  const auto twice = replay({file("grid.g2o")});
  EXPECT_EQ(twice.exit_code, 4);
  EXPECT_THAT(twice.err, HasSubstr("the map has robot 'grid' from a run before: replay it as "
                                   "another one with --prefix, or into an empty data folder with "
                                   "another --spool"));
  const auto other = replay({file("grid.g2o"), "--prefix", "second-"});
  EXPECT_EQ(other.exit_code, 0) << other.err;
  EXPECT_EQ(json::parse(ask({"status", "--json"}).out)["variables"], 20);
}

// A false loop is kept out, told, and taken back; the map stays what it was without it.
TEST_F(DaemonVerbs, KeepAFalseLoopOutAndUndoIt) {
  ASSERT_EQ(run_cairn({"simulate", "city", "--poses", "60", "-o", file("city.g2o")}).exit_code, 0);
  start();
  ASSERT_EQ(replay({file("city.g2o")}).exit_code, 0);
  const std::string before = ask({"settle"}).out;
  const std::string chi2 = before.substr(before.find("chi2"));
  auto client =
      cairn::Client::connect({.domain = static_cast<std::uint32_t>(std::stoi(own_domain())),
                              .source = "mirror",
                              .robot = "city",
                              .spool = file("mirror-spool")});
  ASSERT_TRUE(client);
  cairn::Transaction loop;
  loop.factors.push_back({cairn::FactorType{1},
                          cairn::FactorKind::kLoop,
                          {{{"city", 0}, 5}, {{"city", 0}, 40}},
                          {0.5, 0.5, 0.1, 100.0, 0.0, 0.0, 100.0, 0.0, 400.0}});
  const auto receipt = client->submit(loop, std::chrono::seconds(20));
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  ASSERT_FALSE(receipt->refusal) << receipt->reason;
  EXPECT_THAT(ask({"settle"}).out, HasSubstr(chi2));
  const std::string record = std::to_string(receipt->revision.number);
  EXPECT_THAT(ask({"edge", "show", record}).out, HasSubstr("quarantined"));
  EXPECT_THAT(ask({"log", "--kind", "verdict", "--limit", "1"}).out,
              HasSubstr("mirror/1#0 is quarantined: does not fit the map "));
  EXPECT_THAT(std::string(json::parse(ask({"status", "--json"}).out)["message"]),
              HasSubstr("1 loop closure is quarantined (cairn log --kind verdict)"));
  const auto quarantine = json::parse(ask({"status", "--json"}).out)["quarantine"];
  EXPECT_EQ(quarantine["count"], 1);
  EXPECT_EQ(quarantine["newest"][0]["factor"], record + ":0");
  EXPECT_THAT(ask({"explain", "edge", record + ":0"}).out, HasSubstr("does not fit the map"));
  EXPECT_THAT(ask({"explain", "node", "city/0/40"}).out, HasSubstr(record + ":0"));
  ASSERT_THAT(ask({"edge", "trust", record + ":0"}).out, HasSubstr("1 factor trusted, record "));
  EXPECT_THAT(ask({"settle"}).out, Not(HasSubstr(chi2)));
  ASSERT_EQ(ask({"revoke", "--source", "mirror", "--since", record}).exit_code, 0);
  EXPECT_THAT(ask({"settle"}).out, HasSubstr(chi2));
  EXPECT_THAT(ask({"log", "--kind", "command", "--limit", "1"}).out,
              HasSubstr("revoke --source mirror --since " + record + ": 1 factor disabled"));
  ASSERT_EQ(ask({"edge", "enable", record}).exit_code, 0);
  const auto undone = ask({"undo", record, "--reason", "a mirror", "--operator", "anna"});
  ASSERT_EQ(undone.exit_code, 0) << undone.err;
  EXPECT_THAT(undone.out, HasSubstr("1 factor disabled, record "));
  EXPECT_THAT(ask({"settle"}).out, HasSubstr(chi2));
  EXPECT_THAT(ask({"edge", "show", record}).out, HasSubstr("disabled"));
  EXPECT_THAT(ask({"log"}).out,
              HasSubstr("anna: undo " + record + ": 1 factor disabled (a mirror)"));
  EXPECT_EQ(ask({"undo", "100000"}).exit_code, 2);
}

TEST_F(DaemonVerbs, TakeGnssAtOneDatum) {
  ASSERT_EQ(run_cairn({"simulate", "landmarks", "--sensor", "gnss3", "--poses", "30", "-o",
                       file("fixes.g2o")})
                .exit_code,
            0);
  start();
  const auto bad = replay({file("fixes.g2o"), "--datum", "91", "8.5", "400"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("--datum expects latitude, longitude (deg) and height (m), found "
                                 "91 8.5 400"));
  const auto first = replay({file("fixes.g2o"), "--datum", "47.25", "8.5", "400"});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  const auto status = json::parse(ask({"status", "--json"}).out);
  EXPECT_EQ(status["datum"], (json{47.25, 8.5, 400.0}));
  EXPECT_THAT(ask({"status"}).out, HasSubstr("47.25 N 8.5 E 400 m"));
  const auto other = replay({file("fixes.g2o"), "--prefix", "b-", "--datum", "47.5", "8.5", "400"});
  EXPECT_EQ(other.exit_code, 4);
  EXPECT_THAT(other.err, HasSubstr("was refused: other datum: factor 0: its datum is 47.5 8.5 400, "
                                   "that of this map is 47.25 8.5 400"));
}

// Poses and landmarks as a watching program receives them, so many in all. They come on topics of
// their own, in any order.
struct Received {
  Received(const std::string& domain, std::size_t expected) {
    auto client = cairn::Client::connect({.domain = static_cast<std::uint32_t>(std::stoi(domain))});
    if (!client) return;
    std::map<std::pair<cairn::OdometryFrame, std::uint32_t>, cairn::PoseChunk> chunks;
    std::map<std::pair<cairn::OdometryFrame, std::uint32_t>, cairn::LandmarkChunk> seen;
    std::mutex mutex;
    std::condition_variable arrived;
    client->on_poses([&](const cairn::PoseUpdate& update) {
      const std::lock_guard lock(mutex);
      for (const auto& chunk : update.chunks) chunks[{chunk.frame, chunk.chunk}] = chunk;
      revisions = update.revisions;
      arrived.notify_all();
    });
    client->on_landmarks([&](const auto&, const std::vector<cairn::LandmarkChunk>& update) {
      const std::lock_guard lock(mutex);
      for (const auto& chunk : update) seen[{chunk.frame, chunk.chunk}] = chunk;
      arrived.notify_all();
    });
    std::unique_lock lock(mutex);
    arrived.wait_for(lock, std::chrono::seconds(20), [&] {
      std::size_t count = 0;
      for (const auto& [key, chunk] : chunks) count += chunk.poses.size();
      for (const auto& [key, chunk] : seen) count += chunk.landmarks.size();
      return count >= expected && revisions &&
             revisions->solved.number + 1 >= revisions->graph.number;
    });
    lock.unlock();
    client->on_poses({});
    client->on_landmarks({});
    for (const auto& [key, chunk] : chunks) {
      maps.insert(chunk.map);
      for (const auto& pose : chunk.poses) {
        std::vector<double> numbers(pose.T_map_body.begin(), pose.T_map_body.end());
        for (std::size_t i = 3; i < 7 && pose.T_map_body[6] < 0.0; ++i) numbers[i] = -numbers[i];
        poses[pose.index] = numbers;
      }
    }
    for (const auto& [key, chunk] : seen) {
      for (const auto& landmark : chunk.landmarks)
        landmarks[landmark.index] = {landmark.p_map.begin(), landmark.p_map.end()};
    }
  }
  std::optional<cairn::EstimateRevisions> revisions;
  std::set<std::string> maps;
  std::map<std::uint64_t, std::vector<double>> poses, landmarks;  ///< by index, w >= 0
};

// What a robot's file became: settled to the batch optimum, and published so.
struct ReplayCase {
  std::string name;
  std::vector<std::string> files;
};

void PrintTo(const ReplayCase& replayed, std::ostream* out) { *out << replayed.name; }

class Replay : public DaemonVerbs, public testing::WithParamInterface<ReplayCase> {};

TEST_P(Replay, SettlesToTheBatchOptimumAndPublishesIt) {
  std::vector<std::string> files;
  for (const std::string& name : GetParam().files) {
    CAIRN_REQUIRE_DATASET(path, "graphs/" + name);
    files.push_back(path);
  }
  start();
  const auto sent = replay(files);
  ASSERT_EQ(sent.exit_code, 0) << sent.err;

  auto optimize = files;
  optimize.insert(optimize.begin(), "optimize");
  optimize.insert(optimize.end(), {"--json", file("report.json"), "--quiet"});
  ASSERT_EQ(run_cairn(optimize).exit_code, 0);
  const auto report = json::parse(read_file(file("report.json")));
  const double optimum = report["final_chi2"];
  EXPECT_NEAR(chi2_in(sent.out), optimum, 1e-6 * std::max(1.0, optimum));

  const auto status = json::parse(ask({"status", "--json"}).out);
  EXPECT_EQ(status["variables"], report["vertices"]);
  EXPECT_EQ(status["factors"], report["edges"]);

  // What is received over DDS is what is settled, number by number.
  const Received received(own_domain(), status["variables"]);
  EXPECT_EQ(received.maps.size(), 1u) << "every robot is tied to the others";
  ASSERT_EQ(ask({"export", "graph", file("settled.g2o")}).exit_code, 0);
  const auto settled = cairn::read_graph(file("settled.g2o"));
  ASSERT_TRUE(settled) << settled.error().to_string();
  const auto variables = settled->graph.variables();
  EXPECT_EQ(received.poses.size() + received.landmarks.size(), variables.size());
  for (cairn::VariableSlot slot = 0; slot < variables.size(); ++slot) {
    const auto value = cairn::describe_value(settled->graph, slot);
    const auto& all = is_pose(variables[slot].type) ? received.poses : received.landmarks;
    const auto found = all.find(variables[slot].id.value);
    ASSERT_NE(found, all.end()) << variables[slot].id.value;
    for (std::size_t k = 0; k < value.size(); ++k)
      EXPECT_NEAR(found->second[k], value[k], 1e-12) << variables[slot].id.value;
  }
  ASSERT_EQ(stop(), 0);
  EXPECT_EQ(ask_folder({"verify"}).exit_code, 0);
}

std::vector<ReplayCase> replay_cases() {
  const auto four = [](const std::string& folder) {
    std::vector<std::string> files;
    for (int i = 0; i < 4; ++i)
      files.push_back("multirobot/" + folder + '/' + std::to_string(i) + ".g2o");
    return files;
  };
  return {{"manhattan", {"pose2/manhattan.g2o"}},
          {"intel", {"pose2/intel.g2o"}},
          {"sphere2500", {"pose3/sphere2500.g2o"}},
          {"parking_garage", {"pose3/parking-garage.g2o"}},
          {"csail_edges_only", {"pose2/CSAIL.g2o"}},
          {"victoria_park", {"landmarks/victoriaPark.txt"}},
          {"dlr", {"landmarks/dlr/"}},
          {"argos_clean_4robots", four("argos_clean_4robots")},
          {"blocks_4robots", four("blocks_4robots")}};
}

INSTANTIATE_TEST_SUITE_P(Public, Replay, testing::ValuesIn(replay_cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
