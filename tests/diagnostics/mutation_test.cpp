// SPDX-License-Identifier: BSD-3-Clause
// Random damage: the lint and the readers must agree about it, and nothing may crash.
#include <gtest/gtest.h>

#include <random>

#include "cairn/diagnostics/lint.hpp"
#include "tests/diagnostics/lint_support.hpp"

namespace cairn {
namespace {

const char* const kSeeds[] = {
    "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.1\nVERTEX_SE2 2 2 0.1 0.2\nVERTEX_XY 9 3 3\nFIX 0\n"
    "EDGE_SE2 0 1 1 0 0.1 10 1 0 10 0 40\nEDGE_SE2 1 2 1 0 0.1 10 0 0 10 0 40\nEDGE_SE2 0 2 2 0.1 "
    "0.2 10 0 0 10 0 40\n"
    "EDGE_SE2_XY 0 9 3 3 1 0 1\nEDGE_BEARING_SE2_XY 1 9 0.9 5\nEDGE_PRIOR_SE2 2 2 0 0.2 1 0 0 1 0 "
    "1\n"
    "PARAMS_SE2OFFSET 0 0.1 0 0\nEDGE_SE2_OFFSET 0 1 0 0 1 0 0.1 1 0 0 1 0 1\n",
    "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0.1 0.995\nVERTEX_TRACKXYZ 5 1 2 "
    "3\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"
    "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0.1 0.995 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
    "EDGE_SE3_TRACKXYZ 0 5 0 1 2 3 1 0 0 1 0 1\nEDGE_SE3_PRIOR 0 0 0 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 "
    "0 0 1 0 0 0 1 0 0 1 0 1\n"
    "EDGE_CAIRN_RANGE 0 5 3.7 1\n",
    "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 2 0 0\nEDGE2 0 1 1 0 0 1 0 1 2 0 0\nEDGE2 1 2 1 0 "
    "0 1 0 1 2 0 0\nEQUIV 0 7\n"
    "EDGE2 2 7 -2 0 0\nVERTEX3 10 0 0 0 0 0 0\nVERTEX3 11 1 0 0 0 0 0.1\nEDGE3 10 11 1 0 0 0 0 "
    "0.1\n",
    "ODOMETRY 0 1 1 0 0 1 0 0 1 0 1\nEDGE2 1 2 1 0 0 1 0 0 1 0 1\nLANDMARK 1 5 1 1 1 0 1\nLANDMARK "
    "2 5 0 1 1 0 1\nODOMETRY 2 3 1 0 0.5\n",
};

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string damage(std::string text) {
    for (std::size_t n = 1 + pick(3); n > 0 && !text.empty(); --n) damage_once(text);
    return text;
  }

 private:
  std::size_t pick(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }

  void damage_once(std::string& text) {
    static const char* const kWords[] = {"nan",
                                         "-inf",
                                         "1e999",
                                         "1,5",
                                         "1,234",
                                         "-1",
                                         "18446744073709551615",
                                         "18446744073709551616",
                                         "0x10",
                                         "",
                                         "1e-400",
                                         "1e308",
                                         "-1e308",
                                         "FIX",
                                         "EDGE_SE2",
                                         "VERTEX_SE3:QUAT",
                                         "EQUIV",
                                         "#",
                                         "\t",
                                         "0 0 0",
                                         "PARAMS_SE2OFFSET"};
    const std::size_t place = pick(text.size());
    switch (pick(6)) {
      case 0:
        text[place] = static_cast<char>(pick(256));
        break;
      case 1:
        text.erase(place, 1 + pick(8));
        break;
      case 2: {  // another field
        const std::size_t begin = text.find_first_of(" \n", place),
                          end = text.find_first_of(" \n", begin + 1);
        if (begin != std::string::npos && end != std::string::npos)
          text.replace(begin + 1, end - begin - 1, kWords[pick(std::size(kWords))]);
        break;
      }
      case 3:
        text.insert(place, kWords[pick(std::size(kWords))]);
        break;
      case 4: {  // a line twice
        const std::size_t begin = text.rfind('\n', place), end = text.find('\n', place);
        if (begin != std::string::npos && end != std::string::npos && begin < end)
          text.insert(end, text.substr(begin, end - begin));
        break;
      }
      default:
        text.resize(place);
    }
  }

  std::mt19937 random_;
};

TEST(Mutation, LintAndReaderAgreeAndRepairingTwiceIsRepairingOnce) {
  constexpr unsigned kRuns = 4000;  // about ten seconds in a sanitizer build
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const std::string text = Mutator(seed).damage(kSeeds[seed % std::size(kSeeds)]);
    const LintOptions options{.limit_per_code = 5, .solve = seed % 100 == 0};
    const LintReport report = lint_graph_text(text, "x", options);
    const auto read = read_graph_text(text, "x");
    ASSERT_EQ(report.clean(), read.ok()) << "seed " << seed << "\n"
                                         << text << "\n"
                                         << (read ? "" : read.error().to_string()) << "\n"
                                         << test::messages(report);
    if (seed % 4 != 0) continue;
    const RepairedText repaired =
        repair_graph_text(text, "x", {.limit_per_code = 5, .solve = false});
    const RepairedText again =
        repair_graph_text(repaired.text, "x", {.limit_per_code = 5, .solve = false});
    ASSERT_TRUE(again.changes.empty()) << "seed " << seed << "\n"
                                       << text << "\n"
                                       << repaired.text << "\n"
                                       << again.changes[0].what;
    if (report.clean()) {
      ASSERT_TRUE(repaired.after.clean()) << "seed " << seed << "\n"
                                          << text << "\n"
                                          << repaired.text;
    }
  }
}

}  // namespace
}  // namespace cairn
