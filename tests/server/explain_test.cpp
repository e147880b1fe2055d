// SPDX-License-Identifier: BSD-3-Clause
// explain edge, explain node: why something is where it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cairn/history/question.hpp"
#include "cairn/history/source_trust.hpp"
#include "tests/server/ordered_map.hpp"

namespace cairn {
namespace {

using test::Json;
using test::OrderedMap;
using testing::HasSubstr;
using testing::Not;

// 30 steps and a false loop, which is record 31, and what is asked of them.
class Explain : public testing::Test {
 protected:
  Explain() {
    map_.take_all(test::drive(30));
    map_.take(test::false_loop(2, 25));
    map_.solve();
  }
  Result<std::string> ask(const std::string& what, Json options) const {
    return answer({"explain " + what, std::move(options)},
                  {map_.journal(), [this] { return Result<PoseGraph>(map_.graph()); }});
  }
  Json edge(const std::string& name) const {
    const auto text = ask("edge", {{"factor", name}, {"json", true}});
    EXPECT_TRUE(text) << text.error().to_string();
    return text ? Json::parse(*text) : Json();
  }
  std::string text(const std::string& what, Json options) const {
    const auto text = ask(what, std::move(options));
    EXPECT_TRUE(text) << text.error().to_string();
    return text ? *text : "";
  }

  OrderedMap map_;
};

TEST_F(Explain, TellsWhyALoopIsOutAndWhatItWouldDo) {
  const Json json = edge("31:0");
  EXPECT_EQ(json["state"], "quarantined");
  EXPECT_EQ(json["source"], "laser");
  ASSERT_EQ(json["verdicts"].size(), 1u);
  EXPECT_EQ(json["verdicts"][0]["state"], "quarantined");
  EXPECT_EQ(json["verdicts"][0]["test"], "does not fit the map");
  EXPECT_FALSE(json["verdicts"][0]["contradicted_by"].empty());
  const double without = json["map"]["chi2_without"], with = json["map"]["chi2_with"];
  EXPECT_NEAR(without, map_.settled()[0], 1e-6 * without);
  EXPECT_GT(with, 100.0 * without);
  // It says that 25 is one meter from 2. What it costs is what it is off by, squared, were the map
  // as stiff as a spring.
  EXPECT_NEAR(json["off"]["distance_m"].get<double>(), 22.0, 1.0);
  EXPECT_EQ(json["off"]["node"], "robot/3/25");
  EXPECT_NEAR(json["off"]["by_the_map"][0].get<double>(), 25.0, 1.0);
  EXPECT_NEAR(json["off"]["by_the_edge"][0].get<double>(), 3.0, 1.0);
  EXPECT_GT(json["off"]["sigma"], 10.0);
  EXPECT_EQ(json["off"]["dimension"], 3);
  // From 2 to 25: three loops of seven steps and two steps, in any order.
  EXPECT_EQ(json["contradiction"]["factors"].size(), 5u);
  EXPECT_GT(json["contradiction"]["chi2"], json["contradiction"]["limit"].get<double>());
  // The gate would take no other loop out for it, so this is the map with it.
  EXPECT_TRUE(json["if_trusted"]["leaves_out"].empty());
  EXPECT_TRUE(json["if_trusted"]["takes_in"].empty());
  EXPECT_NEAR(json["if_trusted"]["chi2"].get<double>(), with, 1e-6 * with);
  const std::string told = text("edge", {{"factor", "31:0"}});
  EXPECT_THAT(told, HasSubstr("quarantined  does not fit the map"));
  EXPECT_THAT(told, HasSubstr("against    5 edges"));
  EXPECT_THAT(told, HasSubstr("trusted    chi2 would be"));
}

TEST_F(Explain, TellsOfALoopThatIsInWhatIsWithoutIt) {
  const double before = map_.settled()[0];
  const std::uint64_t trusted = map_.give("edge trust", {{"factors", {"31:0"}}});
  map_.solve();
  const Json forced = edge("31:0");
  EXPECT_EQ(forced["state"], "trusted");
  ASSERT_EQ(forced["orders"].size(), 1u);
  EXPECT_EQ(forced["orders"][0]["operator"], "anna");
  EXPECT_EQ(forced["orders"][0]["record"], trusted);
  EXPECT_NEAR(forced["if_disabled"]["chi2"].get<double>(), before, 1e-6 * before);
  EXPECT_TRUE(forced["if_disabled"]["leaves_out"].empty());
  const Json honest = edge("30:0");
  EXPECT_EQ(honest["kind"], "odometry");
  EXPECT_FALSE(honest.contains("contradiction")) << "the gate decides nothing about it";
}

// One robot passes all places twice; a false loop, once it is in, pushes true ones out.
TEST(ExplainTrusted, NamesTheLoopsThatTheGateWouldLeaveOut) {
  OrderedMap map;
  for (std::uint64_t i = 0; i < 60; ++i) {
    Transaction step = test::drive_step("robot", i);
    step.factors.resize(std::min<std::size_t>(step.factors.size(), 1));
    map.take(step);
  }
  const auto tie = [&](std::uint64_t a, std::uint64_t b, double x) {
    Transaction loop = test::false_loop(a, b);
    loop.factors[0].numbers = {x, 0.0, 0.0, 1e4, 0.0, 0.0, 1e4, 0.0, 1e4};
    return map.take(loop);
  };
  for (std::uint64_t i = 0; i < 25; ++i) tie(i, i + 30, 30.0);
  const std::uint64_t wrong = tie(10, 41, 28.0);
  map.solve();
  const auto ask = [&] {
    const auto text =
        answer({"explain edge", {{"factor", std::to_string(wrong) + ":0"}, {"json", true}}},
               {map.journal(), [&] { return Result<PoseGraph>(map.graph()); }});
    EXPECT_TRUE(text) << text.error().to_string();
    return text ? Json::parse(*text) : Json();
  };
  const Json out = ask();
  EXPECT_EQ(out["state"], "quarantined");
  EXPECT_EQ(out["contradiction"]["factors"].size(), 2u) << "the loop next to it, and a step";
  const std::size_t pushed_out = out["if_trusted"]["leaves_out"].size();
  EXPECT_GT(pushed_out, 0u);
  map.give("edge trust", {{"factors", {std::to_string(wrong)}}});
  map.solve();
  const Json in = ask();
  EXPECT_EQ(in["state"], "trusted");
  EXPECT_EQ(in["if_disabled"]["takes_in"].size(), pushed_out);
}

TEST_F(Explain, SaysSoWhereNothingElseTies) {
  // The last step has one loop: without it and its odometry it would be free.
  map_.give("edge disable", {{"factors", {"30:1"}}});
  const Json only = edge("30:0");
  EXPECT_FALSE(only["tied_by_others"]);
  EXPECT_TRUE(only["off"].is_null());
  EXPECT_THAT(text("edge", {{"factor", "30:0"}}), HasSubstr("nothing else ties its ends together"));
}

TEST_F(Explain, TellsWhereANodeIsAndWhatSaysSo) {
  for (const char* name : {"robot/3/25", "26:0"}) {
    const Json json = Json::parse(text("node", {{"node", name}, {"json", true}}));
    EXPECT_EQ(json["node"], "robot/3/25");
    EXPECT_EQ(json["record"], 26);
    EXPECT_NEAR(json["estimate"][0].get<double>(), 25.0, 1.0);
    ASSERT_EQ(json["sigma"].size(), 3u);
    EXPECT_EQ(json["covariance"].size(), 6u);
    EXPECT_NEAR(std::pow(json["sigma"][0].get<double>(), 2), json["covariance"][0].get<double>(),
                1e-12);
    // Seven steps, or a loop, from the first pose are worth more than 0.1 m.
    EXPECT_GT(json["sigma"][0], 0.1);
    EXPECT_LT(json["sigma"][0], 0.5);
    ASSERT_EQ(json["factors"].size(), 4u);
    EXPECT_EQ(json["factors"][0]["factor"], "31:0") << "what is out comes first";
    EXPECT_EQ(json["factors"][0]["verdicts"].size(), 1u);
  }
  const std::string told = text("node", {{"node", "robot/3/25"}});
  EXPECT_THAT(told, HasSubstr("node       robot/3/25 (SE(2) pose) of record 26"));
  EXPECT_THAT(told, HasSubstr("sigma      x m 0."));
  EXPECT_THAT(told, HasSubstr("31:0        quarantined"));
}

TEST_F(Explain, SaysWhichNamesItDoesNotKnow) {
  const auto refusal = [&](const char* what, Json options) {
    const auto text = ask(what, std::move(options));
    EXPECT_FALSE(text);
    EXPECT_EQ(text.error().code, ErrorCode::kUsage);
    return text.error().message;
  };
  EXPECT_EQ(refusal("edge", {{"factor", "30"}}), "record 30 has 2 factors; name one, such as 30:0");
  EXPECT_THAT(refusal("edge", {{"factor", "99:0"}}), HasSubstr("there is no factor 99:0"));
  EXPECT_THAT(refusal("edge", Json::object()), HasSubstr("names no factor"));
  for (const char* name : {"robot/3/30", "robot", "", "31:0", "1:1", ":", "1:", ":0"})
    EXPECT_THAT(refusal("node", {{"node", name}}), HasSubstr("there is no node '"));
  EXPECT_THAT(refusal("node", {{"edge", "1:0"}}), HasSubstr("has no option 'edge'"));
}

// Two sources measure alike, and one states a third of the sigma.
TEST(SourceTrust, TellsWhoIsOverConfident) {
  OrderedMap map;
  for (std::uint64_t i = 0; i < 150; ++i) map.take(test::drive_step("robot", i), "honest");
  for (std::uint64_t i = 0; i < 150; ++i) {
    Transaction step = test::drive_step("other", i);
    for (NewFactor& factor : step.factors)
      for (std::size_t k = 3; k < factor.numbers.size(); ++k) factor.numbers[k] *= 9.0;
    map.take(step, "boaster");
  }
  map.solve();
  std::map<std::string, double> factors;
  for (const SourceTrust& row : measure_trust(map.graph())) {
    EXPECT_GT(row.factors, 10u);
    EXPECT_LE(row.redundancy, 3.0 * static_cast<double>(row.factors));
    factors[row.source + ' ' + row.robot + (row.kind == FactorKind::kLoop ? " loops" : "")] =
        row.sigma_factor;
  }
  ASSERT_TRUE(factors.contains("boaster other") && factors.contains("boaster other loops"));
  ASSERT_TRUE(factors.contains("honest robot") && factors.contains("honest robot loops"));
  // Both state sigmas of 0.1 m and 0.05 rad, and have 0.05 m and rad, or a third of what is stated.
  EXPECT_NEAR(factors["honest robot"], 0.7, 0.25);
  EXPECT_NEAR(factors["honest robot loops"], 0.7, 0.25);
  EXPECT_NEAR(factors["boaster other"] / factors["honest robot"], 3.0, 0.6);
  EXPECT_NEAR(factors["boaster other loops"] / factors["honest robot loops"], 3.0, 0.6);
  EXPECT_EQ(describe({.sigma_factor = 3.14}), "3.1x over-confident");
  EXPECT_EQ(describe({.sigma_factor = 1.2}), "honest");
  EXPECT_EQ(describe({.sigma_factor = 0.25}), "4x under-confident");
}

}  // namespace
}  // namespace cairn
