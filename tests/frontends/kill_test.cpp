// SPDX-License-Identifier: BSD-3-Clause
// Daemon and front-end are killed in the middle of a real log, and started again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>

#include "tests/support/datasets.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::Process;
using test::ProcessResult;

/// One map of intel.clf, made by both processes.
class IntelRun {
 public:
  explicit IntelRun(const std::filesystem::path& laser) : laser_(laser) { start_daemon(); }

  void kill_daemon() {
    EXPECT_EQ(daemon_.end(SIGKILL).exit_code, 128 + SIGKILL) << "it ended by itself";
    start_daemon();
  }
  [[nodiscard]] Process frontend() const {
    return Process({FRONTEND_BINARY, "laser", "--input", laser_ / "intel.clf.bz2", "--robot",
                    "pioneer", "--spool", folder_.file("spool"), "--domain", domain_, "--settle",
                    "--trajectory", folder_.file("pioneer.tum")});
  }
  void stop_daemon() { EXPECT_EQ(daemon_.end(SIGTERM).exit_code, 0); }

  /// Mean error of the relations, m.
  [[nodiscard]] double relations_error_m() const {
    const ProcessResult judged =
        Process({CAIRN_BINARY, "eval", "relations", laser_ / "intel.relations",
                 folder_.file("pioneer.tum"), "--strict", "--quiet", "--json", "-"})
            .wait();
    EXPECT_EQ(judged.exit_code, 0) << judged.err;
    return nlohmann::json::parse(judged.out)["translation"]["mean"];
  }

  struct Content {
    std::size_t keyframes = 0;
    std::multiset<std::pair<std::string, std::string>> edges;
  };
  [[nodiscard]] Content content() const {
    const std::string file = folder_.file("map.g2o");
    const ProcessResult exported =
        Process({CAIRN_BINARY, "export", "graph", file, "--data", data()}).wait();
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    Content found;
    std::istringstream lines(test::read_file(file));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string tag, a, b;
      words >> tag >> a >> b;
      found.keyframes += tag == "VERTEX_SE2";
      if (tag == "EDGE_SE2") found.edges.emplace(a, b);
    }
    return found;
  }

 private:
  [[nodiscard]] std::string data() const { return folder_.file("data"); }
  void start_daemon() { daemon_ = Process({CAIRND_BINARY, "--data", data(), "--domain", domain_}); }

  const std::filesystem::path laser_;
  const test::TemporaryFolder folder_;
  const std::string domain_ = std::to_string(test::own_domain());
  Process daemon_;
};

TEST(FrontendKill, LosesAndDoublesNothingOfARealLog) {
  CAIRN_REQUIRE_DATASET(laser, "laser");
  const char* given = std::getenv("CAIRN_SEED");
  const std::uint64_t seed = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "CAIRN_SEED=" << seed << '\n';
  IntelRun quiet(laser);
  {
    const ProcessResult result = quiet.frontend().wait();
    ASSERT_EQ(result.exit_code, 0) << result.err;
    quiet.stop_daemon();
  }

  IntelRun disturbed(laser);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> pause_ms(500, 3000);
  Process frontend = disturbed.frontend();
  for (int kill = 0; kill < 6; ++kill) {
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms(random)));
    if (kill % 2 == 0) {
      disturbed.kill_daemon();
      continue;
    }
    EXPECT_EQ(frontend.end(SIGKILL).exit_code, 128 + SIGKILL) << "it was through already";
    frontend = disturbed.frontend();
  }
  const ProcessResult result = frontend.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  disturbed.stop_daemon();

  const IntelRun::Content whole = quiet.content(), mended = disturbed.content();
  EXPECT_GT(whole.keyframes, 1000U);
  EXPECT_EQ(mended.keyframes, whole.keyframes);
  for (const auto& edge : mended.edges)
    EXPECT_EQ(mended.edges.count(edge), 1U) << edge.first << ' ' << edge.second << " came twice";
  const double undisturbed_m = quiet.relations_error_m();
  std::cout << "relations " << undisturbed_m << " m, killed " << disturbed.relations_error_m()
            << " m; " << whole.keyframes << " keyframes, " << whole.edges.size() << " and "
            << mended.edges.size() << " edges\n";
  EXPECT_LT(disturbed.relations_error_m(), 1.1 * undisturbed_m);
}

}  // namespace
}  // namespace cairn
