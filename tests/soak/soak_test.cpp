// SPDX-License-Identifier: BSD-3-Clause
// Three robots, an operator and the real daemon as processes over DDS: growth, then the same roads
// again, then standing still; true and false loop closures; orders and their undoing; robots and
// daemon killed and started again. CAIRN_SOAK_MINUTES sets how long (0.4), CAIRN_SEED
// repeats what is sent.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/apply_record.hpp"
#include "cairn/journal/journal.hpp"
#include "tests/soak/course.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/process_usage.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using test::Course;
using test::Process;

#ifdef __SANITIZE_ADDRESS__
constexpr bool kMemoryIsJudged = false;  // freed memory is kept to find its misuse
#else
constexpr bool kMemoryIsJudged = true;
#endif

std::string setting(const char* name, const std::string& otherwise) {
  const char* text = std::getenv(name);
  return text ? text : otherwise;
}

// Of y over x, by least squares.
double slope(const std::vector<std::pair<double, double>>& points) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const auto& [a, b] : points) n += 1.0, x += a, y += b, xx += a * a, xy += a * b;
  const double spread = n * xx - x * x;
  return spread > 0.0 ? (n * xy - x * y) / spread : 0.0;
}

class Soak : public testing::Test {
 protected:
  Soak() {
    std::cout << "CAIRN_SEED=" << seed_ << ", " << minutes_ << " minutes, " << poses_
              << " poses per robot, domain " << domain_ << "\n\n";
  }

  fs::path data() const { return folder_.path() / "data"; }
  fs::path receipts(std::size_t robot) const {
    return folder_.path() / ("receipts-" + std::to_string(robot));
  }
  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  double length_s() const { return 60.0 * minutes_; }

  void start_daemon() {
    daemon_ = Process({CAIRND_BINARY, "--data", data(), "--config", config_, "--domain",
                       std::to_string(domain_)});
  }
  void start_robot(std::size_t robot) {
    const double period_ms = 1000.0 * kGrowing * length_s() / static_cast<double>(poses_);
    robots_[robot] =
        Process({SOAK_ROBOT_BINARY, std::to_string(domain_),
                 folder_.path() / ("spool-" + std::to_string(robot)), std::to_string(robot),
                 receipts(robot), std::to_string(seed_), std::to_string(poses_),
                 std::to_string(std::lround(period_ms)),
                 std::to_string(std::lround(5.0 * period_ms)), std::to_string(revisits_)});
  }

  // Runs `cairn`; empty where it failed, which fails the test.
  std::string cairn(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), CAIRN_BINARY);
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_)});
    Process process(arguments);
    const auto result = process.wait(10min);
    EXPECT_TRUE(result && result->exit_code == 0)
        << arguments[1] << ' ' << arguments[2] << ": " << (result ? result->err : "hangs");
    return result && result->exit_code == 0 ? result->out : "";
  }
  nlohmann::json status() {
    return nlohmann::json::parse(cairn({"status", "--json"}), nullptr, false);
  }

  void restart(int signal_number) {
    const auto ended = daemon_.end(signal_number);
    EXPECT_EQ(ended.exit_code, signal_number == SIGKILL ? 128 + SIGKILL : 0) << ended.err;
    start_daemon();
  }
  void kill_a_robot() {
    const std::size_t robot = kills_++ % robots_.size();
    EXPECT_EQ(robots_[robot].end(SIGKILL).exit_code, 128 + SIGKILL) << "it ended by itself";
    start_robot(robot);
  }

  // The record of an order.
  std::uint64_t order(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--operator", "anna", "--reason", "soak"});
    const std::string answer = cairn(arguments);
    const std::size_t at = answer.rfind("record ");
    ++orders_;
    return at == std::string::npos ? 0 : std::strtoull(answer.c_str() + at + 7, nullptr, 10);
  }
  void take_back_oldest() {
    const std::uint64_t record = standing_orders_.front();
    standing_orders_.pop_front();
    order({"undo", std::to_string(record)});
  }
  // Switches something off that came lately, and something older on again.
  void give_orders() {
    const std::size_t robot = orders_ % robots_.size();
    std::ifstream file(receipts(robot));
    std::uint64_t sequence = 0, number = 0;
    struct Candidate {
      std::uint64_t record;
      bool alone;  // it added no pose that others stand on
    };
    std::vector<Candidate> candidates;
    for (Course course = course_of(robot); file >> sequence >> number;) {
      const Transaction step = course.step(sequence - 1).transaction;
      if (step.factors.size() > 1 || step.variables.empty())
        candidates.push_back({number, step.variables.empty()});
    }
    if (candidates.empty()) return;
    const std::size_t back =
        orders_ % 4 == 0 ? 0 : orders_ * 7 % std::min<std::size_t>(50, candidates.size());
    const auto [record, alone] = *(candidates.rbegin() + static_cast<std::ptrdiff_t>(back));
    const std::string name = std::to_string(record);
    const std::uint64_t ordered = alone       ? order({"undo", name})
                                  : back == 0 ? order({"undo", name, "--cascade"})
                                              : order({"edge", "disable", name + ":1"});
    if (ordered != 0) standing_orders_.push_back(ordered);
    while (standing_orders_.size() > 2) take_back_oldest();
  }

  Course course_of(std::size_t robot) const { return {seed_, robot, poses_}; }

  void print_row() {
    const nlohmann::json now = status();
    if (!now.is_object()) return;
    std::printf("| %.1f | %s | %zu | %zu | %d | %d | %.1f | %.1f |\n", elapsed_s() / 60.0,
                now["head"]
                    .get<std::string>()
                    .substr(now["head"].get<std::string>().rfind(':') + 1)
                    .c_str(),
                now["variables"].get<std::size_t>(), now["factors"].get<std::size_t>(), orders_,
                kills_, test::resident_mb(daemon_.id()), journal_mb());
    std::fflush(stdout);
  }
  double journal_mb() const {
    double bytes = 0.0;
    for (const auto& entry : fs::recursive_directory_iterator(data()))
      if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
    return bytes / 1e6;
  }

  void live() {
    std::printf(
        "| minutes | records | poses | factors | orders | robots killed | memory, MB | "
        "data folder, MB |\n|---|---|---|---|---|---|---|---|\n");
    const double row_s = std::min(60.0, length_s() / 8.0);
    const double kill_s = std::max(8.0, length_s() / 40.0);
    double next_row = row_s, next_kill = kill_s, next_order = length_s() / 50.0;
    std::deque<std::pair<double, int>> restarts{{0.15 * length_s(), SIGKILL},
                                                {0.3 * length_s(), SIGTERM}};
    for (double now = 0.0; now < length_s() && !HasFailure(); now = elapsed_s()) {
      std::this_thread::sleep_for(100ms);
      if (!restarts.empty() && now > restarts.front().first) {
        restart(restarts.front().second);
        restarts.pop_front();
      }
      if (now > next_kill) kill_a_robot(), next_kill += kill_s;
      if (now > next_order) give_orders(), next_order += length_s() / 50.0;
      if (now > next_row) print_row(), next_row += row_s;
      memory_.emplace_back(now / 60.0, test::resident_mb(daemon_.id()));
    }
    while (!standing_orders_.empty()) take_back_oldest();
    print_row();
  }

  // Robots that are there and send nothing new.
  void stand_still() {
    for (const Process& robot : robots_) {
      robot.send(SIGUSR1);
      for (int i = 0; i < 1200 && robot.out().empty(); ++i) std::this_thread::sleep_for(50ms);
      ASSERT_FALSE(robot.out().empty()) << "a robot waits for ever";
    }
    cairn({"settle"});
    const auto before = status()["head"];
    std::this_thread::sleep_for(5s);
    const auto after = status();
    EXPECT_EQ(after["head"], before) << "a robot that stands still adds to the journal";
    EXPECT_EQ(after["sources"].size(), robots_.size());
    for (const auto& source : after["sources"]) EXPECT_EQ(source["alive"], true);
  }

  void end() {
    for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
      const auto result = robots_[robot].end(SIGTERM);
      EXPECT_EQ(result.exit_code, 0) << result.err;
      steps_[robot] = std::strtoull(result.out.c_str(), nullptr, 10);
    }
    EXPECT_EQ(daemon_.end(SIGTERM).exit_code, 0);
  }

  // Every step is there once, in order, where its receipt says.
  void check_nothing_lost(const Journal& journal) {
    std::map<std::string, std::vector<std::uint64_t>> found;  // record by sequence
    ASSERT_TRUE(journal.for_each(1, [&](const Record& record) -> Result<void> {
      if (const auto* transaction = std::get_if<TransactionRecord>(&record.body)) {
        EXPECT_TRUE(std::holds_alternative<Transaction>(transaction->outcome));
        std::vector<std::uint64_t>& own = found[transaction->key().source];
        own.push_back(record.number);
        EXPECT_EQ(transaction->key().sequence, own.size());
      }
      return {};
    }));
    for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
      const std::vector<std::uint64_t>& own = found[Course::kRobots[robot]];
      EXPECT_EQ(own.size(), steps_[robot]);
      std::ifstream file(receipts(robot));
      std::uint64_t sequence = 0, number = 0;
      while (file >> sequence >> number) {
        ASSERT_LE(sequence, own.size()) << Course::kRobots[robot];
        EXPECT_EQ(number, own[sequence - 1]) << Course::kRobots[robot] << ' ' << sequence;
      }
    }
  }

  // Exactly what is false is out.
  void check_states(const PoseGraph& map) {
    std::map<std::string, std::set<std::pair<std::uint64_t, std::uint32_t>>> wrong;
    for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
      Course course = course_of(robot);
      for (std::uint64_t i = 0; i < steps_[robot]; ++i)
        if (const auto place = course.step(i).false_factor)
          wrong[Course::kRobots[robot]].emplace(i + 1, *place);
    }
    int true_loops = 0, false_loops = 0;
    for (std::size_t f = 0; f < map.factors.size(); ++f) {
      const StoredFactor& factor = map.factors[f];
      const TransactionKey& key = factor.name.transaction;
      const bool is_false = wrong[key.source].contains({key.sequence, factor.name.index});
      EXPECT_EQ(factor.state, is_false ? FactorState::kQuarantined : FactorState::kCommitted)
          << (is_false ? "false " : "true ") << key.source << ' ' << key.sequence << ':'
          << factor.name.index;
      if (is_gated(factor.type, factor.kind)) ++(is_false ? false_loops : true_loops);
    }
    EXPECT_GT(false_loops, 0);
    std::cout << "\n"
              << true_loops << " true loop closures are in, " << false_loops
              << " false ones are out.\n";
  }

  // From when on nothing is added any more. A solve takes memory for a moment: what counts is the
  // least of each sixtieth of the time.
  void judge_memory() const {
    std::map<int, std::pair<double, double>> least;
    for (const auto& [minute, mb] : memory_) {
      if (minute < kMoving * minutes_) continue;
      const auto at =
          least.try_emplace(static_cast<int>(60.0 * minute / minutes_), minute, mb).first;
      if (mb < at->second.second) at->second = {minute, mb};
    }
    std::vector<std::pair<double, double>> points;
    for (const auto& [part, point] : least) points.push_back(point);
    const double mb_per_minute = slope(points);
    std::printf("\nMemory from minute %.1f on: %+.3f MB per minute.\n", kMoving * minutes_,
                mb_per_minute);
    if (kMemoryIsJudged && minutes_ >= 10.0) {
      EXPECT_LT(mb_per_minute, kMostGrowth);
    }
  }

  static constexpr double kGrowing = 0.4;  // part of the time in which poses come
  static constexpr double kMoving = 0.7;   // and in which robots drive, with or without new poses
  static constexpr double kMostGrowth = 0.2;  // MB per minute

  const std::uint64_t seed_ = std::strtoull(
      setting("CAIRN_SEED", std::to_string(std::random_device{}())).c_str(), nullptr, 10);
  const double minutes_ = std::strtod(setting("CAIRN_SOAK_MINUTES", "0.4").c_str(), nullptr);
  const std::uint64_t poses_ = minutes_ < 2.0 ? 180 : minutes_ < 10.0 ? 360 : 720;
  const std::uint64_t revisits_ =
      poses_ * 3 / 20;  // of one robot: one where five poses come before
  const std::uint32_t domain_ = test::own_domain();
  test::TemporaryFolder folder_;
  // Else memory grows for half an hour, until the journal has written its first 64 MB.
  const std::string config_ = folder_.write("cairnd.yaml", "journal: {buffer_kb: 64}\n");
  Process daemon_;
  std::array<Process, 3> robots_;
  std::array<std::uint64_t, 3> steps_{};
  const Clock::time_point began_ = Clock::now();
  std::vector<std::pair<double, double>> memory_;  ///< minutes, MB
  std::deque<std::uint64_t> standing_orders_;
  int orders_ = 0, kills_ = 0;
};

TEST_F(Soak, LosesNothingKeepsTheMapAndDoesNotGrow) {
  ASSERT_GT(minutes_, 0.0);
  start_daemon();
  for (std::size_t robot = 0; robot < robots_.size(); ++robot) start_robot(robot);
  live();
  stand_still();
  end();
  {
    const auto journal = Journal::open(data().string());
    ASSERT_TRUE(journal) << journal.error().to_string();
    check_nothing_lost(**journal);
    const auto maps = maps_at(**journal, {(*journal)->head().revision.number});
    ASSERT_TRUE(maps) << maps.error().to_string();
    check_states(maps->front());
  }
  judge_memory();
  const auto began = Clock::now();
  const auto verified = Process({CAIRN_BINARY, "verify", "--data", data()}).wait();
  EXPECT_EQ(verified.exit_code, 0) << verified.err;
  std::cout << '\n'
            << verified.out << "cairn verify took "
            << std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - began).count()
            << " s\n";
}

}  // namespace
}  // namespace cairn
