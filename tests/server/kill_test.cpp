// SPDX-License-Identifier: BSD-3-Clause
// Daemon and clients as processes over real DDS, killed again and again at named points and at
// random moments, while some loop closures are false and operators switch factors and undo records.
// CAIRN_KILLS sets how often (40), CAIRN_SEED repeats a run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <set>

#include "cairn/core/bytes.hpp"
#include "cairn/journal/journal.hpp"
#include "clients/client/client.hpp"
#include "tests/server/drive.hpp"
#include "tests/server/operator.hpp"
#include "tests/server/resender.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::Process;
using test::Receipted;
using test::Resender;

constexpr const char* kRobots[] = {test::kLeader, "follower"};
constexpr const char* kDaemonDeaths[] = {"recovery", "before-commit",   "committed",
                                         "solving",  "before-snapshot", "snapshot-written",
                                         "new-file", "random moment",   "stopped for 2.5 s"};

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

const char* kind_of(const Record& record) {
  constexpr const char* kKinds[] = {"transaction", "order", "verdict", "solve"};
  return kKinds[record.body.index()];
}

class KillTest : public testing::Test {
 protected:
  KillTest() : random_(seed_) {
    std::cout << "CAIRN_SEED=" << seed_ << ", " << kills_ << " kills, domain " << domain_ << '\n';
  }

  fs::path data() const { return folder_.path() / "data"; }
  fs::path told() const { return folder_.path() / "told"; }
  fs::path spool(const std::string& robot) const { return folder_.path() / ("spool-" + robot); }
  fs::path receipts(const std::string& robot) const {
    return folder_.path() / ("receipts-" + robot);
  }

  Process start_daemon(const std::string& point, std::uint64_t count) {
    fs::remove(told());
    return Process({KILLABLE_DAEMON_BINARY, data(), std::to_string(domain_), point,
                    std::to_string(count), told()});
  }
  Process start_client(const std::string& robot) {
    return Process(
        {KILLABLE_CLIENT_BINARY, std::to_string(domain_), spool(robot), robot, receipts(robot)});
  }

  std::uint64_t draw(std::uint64_t first, std::uint64_t last) {
    return std::uniform_int_distribution<std::uint64_t>(first, last)(random_);
  }

  // One life of the daemon.
  void let_die(const std::string& death) {
    const bool at_point = death != kDaemonDeaths[7] && death != kDaemonDeaths[8];
    const std::uint64_t most = death == "recovery" ? std::max<std::uint64_t>(records_, 1)
                               : death.ends_with("commit") || death == "committed" ? 12
                               : death == "solving"                                ? 6
                                                                                   : 2;
    Process daemon = start_daemon(at_point ? death : "none", draw(1, most));
    ASSERT_TRUE(daemon.runs());
    if (death == kDaemonDeaths[8]) {
      std::this_thread::sleep_for(300ms);
      daemon.send(SIGSTOP);
      std::this_thread::sleep_for(2500ms);  // longer than the lease: clients think it is gone
      daemon.send(SIGCONT);
      std::this_thread::sleep_for(300ms);
    } else if (!at_point) {
      std::this_thread::sleep_for(std::chrono::milliseconds(draw(20, 600)));
    }
    const auto dead = at_point ? daemon.wait(3s) : std::nullopt;
    if (dead) {
      ASSERT_TRUE(fs::exists(told())) << "the daemon ended by itself: " << dead->err;
      ++deaths_[death];
    } else {
      daemon.end(SIGKILL);
      ++deaths_[at_point ? kDaemonDeaths[7] : death];
    }
  }

  Receipted read_receipts() const {
    Receipted all;
    for (const char* robot : kRobots) {
      std::ifstream file(receipts(robot));
      std::uint64_t sequence = 0, number = 0;
      while (file >> sequence >> number) all[{robot, sequence}] = number;
    }
    return all;
  }

  // What is receipted is in the journal, where the receipt says, and nothing is there twice; so is
  // every order that was answered.
  void check_journal() {
    const Receipted promised = read_receipts();
    const test::RestlessOperators::Promises orders = operators_.promises();
    JournalOptions options;
    options.read_only = true;
    const auto journal = Journal::open(data().string(), options);
    if (!journal && promised.empty()) return;  // killed before there was one
    ASSERT_TRUE(journal) << journal.error().to_string();
    Receipted found;
    test::RestlessOperators::Promises obeyed;
    const char* last = "nothing";
    std::uint64_t verdicts = 0;
    ASSERT_TRUE((*journal)->for_each(1, [&](const Record& record) -> Result<void> {
      last = kind_of(record);
      verdicts += std::holds_alternative<VerdictRecord>(record.body);
      if (const auto* command = std::get_if<CommandRecord>(&record.body))
        obeyed[record.number] = order_of(*command)->value().asked;
      if (const auto* transaction = std::get_if<TransactionRecord>(&record.body)) {
        EXPECT_TRUE(std::holds_alternative<Transaction>(transaction->outcome));
        const TransactionKey& key = transaction->key();
        EXPECT_TRUE(found.emplace(std::pair(key.source, key.sequence), record.number).second)
            << key.source << ' ' << key.sequence << " is there twice";
      }
      return {};
    }));
    for (const auto& [key, number] : promised) {
      const auto there = found.find(key);
      ASSERT_NE(there, found.end()) << key.first << ' ' << key.second << " is lost";
      EXPECT_EQ(there->second, number);
    }
    for (const auto& [number, asked] : orders)
      ASSERT_EQ(obeyed[number], asked) << "order " << number << " is lost";
    ++ends_[last];
    orders_ = orders.size();
    verdicts_ = verdicts;
    records_ = (*journal)->head().revision.number;
    transactions_ = found.size();
    operators_.may_touch(records_);
  }

  // Executes the journal again in a process of its own: the same hash at every revision as before.
  void verify() {
    const fs::path hashes = folder_.path() / "hashes.csv";
    Process verify({CAIRN_BINARY, "verify", "--data", data(), "--hashes", hashes, "--quiet"});
    const auto result = verify.wait(120s);
    ASSERT_TRUE(result);
    ASSERT_EQ(result->exit_code, 0) << result->err;
    const std::string now = test::read_file(hashes);
    ASSERT_FALSE(now.empty());
    EXPECT_TRUE(now.starts_with(hashes_)) << "history has changed";
    hashes_ = now;
  }

  void stop(Process& client) {
    client.send(SIGTERM);
    const auto result = client.wait(60s);
    ASSERT_TRUE(result) << "a client waits for ever";
    EXPECT_EQ(result->exit_code, 0) << result->err;
  }

  const std::uint64_t seed_ = from_environment("CAIRN_SEED", std::random_device{}());
  const std::uint64_t kills_ = from_environment("CAIRN_KILLS", 40);
  const std::uint32_t domain_ = test::own_domain();
  test::TemporaryFolder folder_;
  std::mt19937_64 random_;
  std::map<std::string, int> deaths_, ends_;
  std::uint64_t records_ = 0, transactions_ = 0, orders_ = 0, verdicts_ = 0;
  std::string hashes_;
  test::RestlessOperators operators_{domain_, seed_, 6, {std::begin(kRobots), std::end(kRobots)}};
};

// The map of a run that nothing disturbs: one robot after the other, what operators have switched
// off was never sent, and what they trust is trusted at once.
PoseGraph undisturbed(const std::map<std::string, std::uint64_t>& steps, const PoseGraph& after) {
  std::set<std::tuple<std::string, std::uint64_t, std::uint32_t>> off, trusted;
  std::map<NodeId, bool> counts;
  for (std::size_t f = 0; f < after.factors.size(); ++f) {
    const StoredFactor& factor = after.factors[f];
    const TransactionKey& key = factor.name.transaction;
    if (!is_enabled(factor.state)) off.emplace(key.source, key.sequence, factor.name.index);
    if (factor.state == FactorState::kTrusted)
      trusted.emplace(key.source, key.sequence, factor.name.index);
    for (const NodeIndex node : factor.nodes)
      counts[after.nodes[node].id] |= is_enabled(factor.state);
  }
  MapHead head;
  std::uint64_t number = 0;
  for (const char* robot : kRobots) {
    for (std::uint64_t i = 0; i < steps.at(robot); ++i) {
      Transaction step = test::troubled_step(robot, i);
      step.key = {robot, 1, i + 1};
      std::erase_if(step.variables, [&](const NewVariable& v) { return !counts.at(v.node); });
      std::uint32_t place = 0, kept = 0;
      std::vector<FactorEdit> trust;
      std::erase_if(step.factors, [&](const NewFactor&) {
        const std::tuple name{std::string(robot), i + 1, place++};
        if (off.contains(name)) return true;
        if (trusted.contains(name)) trust.push_back({{step.key, kept}, FactorChange::kTrust});
        ++kept;
        return false;
      });
      head.apply(step, {1, 0, ++number});
      if (!trust.empty()) head.apply(trust, {1, 0, ++number});
    }
  }
  apply_solution(head, head.graph().graph_revision, solve_map(head.graph()), {1, 0, number + 1});
  return head.graph();
}

// Nodes that count with their estimates, factors with their states, in canonical order.
std::string content_of(const PoseGraph& map) {
  const CanonicalOrder order(map);
  std::string bytes;
  ByteWriter out(bytes);
  for (const NodeIndex node : order.nodes) {
    bytes += to_string(map.nodes[node].id) + '=';
    for (const double number : map.estimates[node]) out.real(number);
  }
  for (const std::uint32_t place : order.factors) {
    const StoredFactor& factor = map.factors[place];
    for (const NodeIndex node : factor.nodes) bytes += to_string(map.nodes[node].id) + ' ';
    out.integer(static_cast<std::uint64_t>(factor.state));
  }
  return bytes;
}

std::ptrdiff_t quarantined(const PoseGraph& map) {
  std::ptrdiff_t count = 0;
  for (std::size_t f = 0; f < map.factors.size(); ++f)
    count += map.factors[f].state == FactorState::kQuarantined;
  return count;
}

PoseGraph recorded(const Journal& journal) {
  MapHead head;
  Sequencer sequencer;
  EXPECT_TRUE(replay_journal(journal, head, sequencer));
  return head.graph();
}

TEST_F(KillTest, LosesAndDoublesNothing) {
  std::map<std::string, Process> clients;
  for (const char* robot : kRobots) clients[robot] = start_client(robot);
  for (std::uint64_t kill = 0; kill < kills_ && !HasFatalFailure(); ++kill) {
    SCOPED_TRACE("kill " + std::to_string(kill));
    if (kill % 5 == 4) {  // a client dies as well, somewhere in this life of the daemon
      const std::string robot = kRobots[draw(0, 1)];
      clients[robot].end(SIGKILL);
      clients[robot] = start_client(robot);
    }
    let_die(kDaemonDeaths[kill % std::size(kDaemonDeaths)]);
    check_journal();
    if ((kill + 1) % std::max<std::uint64_t>(10, kills_ / 6) == 0) verify();  // all of it again
    if (kill == kills_ / 2) {
      for (int i = 0; i < 600 && !fs::exists(spool("follower")); ++i)
        std::this_thread::sleep_for(100ms);  // where all is slow, it has just begun
      clients["follower"].end(SIGKILL);
      fs::copy(spool("follower"), folder_.path() / "copy");
      clients["follower"] = start_client("follower");
    }
  }
  operators_.stop();
  Process daemon = start_daemon("none", 1);
  stop(clients["follower"]);  // first: it waits for poses of the other
  stop(clients[test::kLeader]);

  const auto command = [&](const std::string& text) {
    Result<Client> client = Client::connect({.domain = domain_});
    ASSERT_TRUE(client);
    const auto reply = client->command(text, 60s);
    EXPECT_TRUE(reply) << reply.error().to_string();
  };
  command("settle");
  // Everything is sent once more: from the spools, and from an old copy of one.
  const Receipted promised = read_receipts();
  const auto resend = [&](const std::string& robot, const fs::path& folder) {
    const Receipted answers = Resender(domain_, robot, folder).run();
    EXPECT_FALSE(answers.empty());
    for (const auto& [key, number] : answers) {
      const auto receipt = promised.find(key);
      EXPECT_TRUE(receipt == promised.end() || receipt->second == number ||
                  number == Resender::kStale)
          << key.second;
    }
  };
  for (const char* robot : kRobots) resend(robot, spool(robot));
  resend("follower", folder_.path() / "copy");
  command("settle");
  EXPECT_EQ(daemon.end(SIGTERM).exit_code, 0);

  const std::uint64_t before = transactions_;
  check_journal();
  EXPECT_GE(transactions_, before);
  verify();
  std::map<std::string, std::uint64_t> steps;
  const auto journal = Journal::open(data().string());
  ASSERT_TRUE(journal);
  ASSERT_TRUE((*journal)->for_each(1, [&](const Record& record) -> Result<void> {
    if (const auto* transaction = std::get_if<TransactionRecord>(&record.body)) {
      EXPECT_EQ(transaction->key().sequence, ++steps[transaction->key().source]);
    }
    return {};
  }));
  const PoseGraph map = recorded(**journal);
  EXPECT_TRUE(content_of(map) == content_of(undisturbed(steps, map)));

  std::cout << records_ << " records, " << transactions_ << " transactions; the daemon died at:";
  for (const auto& [death, count] : deaths_) std::cout << ' ' << death << " x" << count << ',';
  std::cout << '\n';
  std::cout << orders_ << " orders, " << verdicts_ << " verdicts; left as last record:";
  for (const auto& [kind, count] : ends_) std::cout << ' ' << kind << " x" << count << ',';
  std::cout << '\n';
  if (kills_ >= 40) {
    for (const char* death : kDaemonDeaths) EXPECT_GT(deaths_[death], 0) << death;
    EXPECT_GT(orders_, 0u);
    EXPECT_GT(quarantined(map), 0);
  }
}

}  // namespace
}  // namespace cairn
