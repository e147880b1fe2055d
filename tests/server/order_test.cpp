// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/ordered_map.hpp"

namespace cairn {
namespace {

using test::Json;
using testing::HasSubstr;

TEST(Undo, LeavesTheMapAsIfTheTransactionHadNeverCome) {
  std::vector<Transaction> steps = test::drive(1030);
  const std::vector<Transaction> later(steps.begin() + 30, steps.end());
  steps.resize(30);
  test::OrderedMap clean, spoiled;
  clean.take_all(steps);
  spoiled.take_all(steps);
  const std::uint64_t mirror = spoiled.take(test::uncertain_false_loop(2, 25));
  clean.take_all(later);
  spoiled.take_all(later);
  const std::vector<double> with_it = spoiled.settled();
  EXPECT_NE(with_it, clean.settled());
  const std::uint64_t undone = spoiled.undo(mirror);
  EXPECT_EQ(spoiled.settled(), clean.settled());
  EXPECT_EQ(spoiled.settled_after_restart(), clean.settled());
  const std::uint64_t again = spoiled.undo(undone);
  EXPECT_EQ(spoiled.settled(), with_it);
  EXPECT_EQ(spoiled.settled_after_restart(), with_it);
  spoiled.undo(again);
  EXPECT_EQ(spoiled.settled(), clean.settled());
  EXPECT_TRUE(spoiled.ask("undo", {{"record", mirror}})->edits.empty()) << "it is undone already";
}

TEST(Undo, OfWhatOthersHaveBuiltOnTakesThemAlongOrIsRefused) {
  const std::vector<Transaction> steps = test::drive(40);
  test::OrderedMap map, until, kept;
  map.take_all(steps);
  const auto refused = map.ask("undo", {{"record", 21u}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotUsable);
  EXPECT_EQ(refused.error().message,
            "later records use variables that record 21 added, and would have been refused without "
            "it: 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40; "
            "--cascade undoes them, too");
  // Another robot, which has nothing to do with it.
  std::vector<Transaction> other;
  for (std::uint64_t i = 0; i < 9; ++i) {
    other.push_back(test::drive_step("other", i + 1));
    if (other.back().factors.size() > 1) other.back().factors.resize(1);
    if (i == 0) other.back().factors.clear();
  }
  map.take_all(other);
  until.take_all({steps.begin(), steps.begin() + 20});
  until.take_all(other);
  kept.take_all(steps);
  kept.take_all(other);
  const std::uint64_t undone = map.undo(21, true);
  EXPECT_EQ(map.settled(), until.settled());
  EXPECT_EQ(map.settled_after_restart(), until.settled());
  map.undo(undone);
  EXPECT_EQ(map.settled(), kept.settled());
}

TEST(Undo, RefusesWhatCannotBeTakenBack) {
  test::OrderedMap map;
  map.take_all(test::drive(10));
  Transaction edits;
  edits.edits.push_back({{{"laser", 7, 9}, 0}, FactorChange::kDisable});
  map.take(edits);
  const std::uint64_t removal = map.give("edge remove", {{"factors", {"10:1"}}});
  const auto message = [&](Json options) { return map.ask("undo", std::move(options)).error(); };
  EXPECT_EQ(message({{"record", 9u}, {"cascade", true}}).message,
            "record 11 switches factors itself, which cannot be taken back with others; use cairn "
            "edge");
  EXPECT_EQ(message({{"record", 11u}}).code, ErrorCode::kNotUsable);
  EXPECT_EQ(message({{"record", removal}}).message,
            "record 12 removed factors for good; disable keeps them");
  EXPECT_EQ(message({{"record", 13u}}).message, "there is no record 13; expected one of 1 to 12");
  EXPECT_EQ(message({{"record", -3}}).code, ErrorCode::kUsage);
  EXPECT_EQ(message({{"number", 3}}).message,
            "undo has no option 'number'; do client and daemon have the same version?");
}

TEST(Edge, SwitchesFactorsByRecordAndPlace) {
  test::OrderedMap map;
  map.take_all(test::drive(10));  // records 8 to 10 bring two factors each
  const std::vector<double> before = map.settled();
  const auto order = map.ask("edge disable", {{"factors", {"9", "10:1", "10:1"}}});
  ASSERT_TRUE(order) << order.error().to_string();
  EXPECT_EQ(count_changes(*order), "3 factors disabled");
  const std::uint64_t disabled = map.give("edge disable", {{"factors", {"9:1", "10:1"}}});
  EXPECT_NE(map.settled(), before);
  EXPECT_TRUE(map.ask("edge disable", {{"factors", {"9:1"}}})->edits.empty());
  map.give("edge enable", {{"factors", {"9:1"}}});
  map.undo(disabled);  // 10:1 is left
  EXPECT_EQ(map.settled(), before);
  map.give("edge remove", {{"factors", {"9:1"}}});
  const auto gone = map.ask("edge enable", {{"factors", {"9:1"}}});
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().message, HasSubstr("what was removed stays removed"));
  EXPECT_FALSE(map.ask("undo", {{"record", disabled}})) << "9:1 was removed since";
}

TEST(Thin, NamesNodesThatAreThereAndBringsNothingBackThatWasRemoved) {
  test::OrderedMap map;
  map.take_all(test::drive(10));
  map.give("edge remove", {{"factors", {"9:1"}}});
  const auto removed = map.ask("thin", {{"nodes", {2u}}, {"by", 9u}});
  ASSERT_FALSE(removed);
  EXPECT_EQ(removed.error().code, ErrorCode::kNotUsable);
  EXPECT_THAT(removed.error().message, HasSubstr("factor 1 of laser/9 is not known"));
  for (const Json& nodes : {Json::array({10u}), Json::array({-1}), Json::array({"2"}), Json(2)}) {
    const auto order = map.ask("thin", {{"nodes", nodes}, {"by", 8u}});
    ASSERT_FALSE(order) << nodes;
    EXPECT_EQ(order.error().message,
              "thin expects the option nodes: numbers below 10, in order of arrival");
  }
}

TEST(Edge, SaysWhichNamesItDoesNotKnow) {
  test::OrderedMap map;
  map.take_all(test::drive(10));
  const std::vector<std::pair<Json, std::string>> cases{
      {{"1"}, "there is no factor 1: record 1 has 0 factors in the map"},
      {{"11:0"}, "there is no factor 11:0: record 11 has 0 factors in the map"},
      {{"10:2"}, "there is no factor 10:2: record 10 has 2 factors in the map"},
      {{"10:"}, "'10:' names no factor; expected RECORD or RECORD:PLACE"},
      {{":1"}, "':1' names no factor"},
      {{"-1"}, "'-1' names no factor"},
      {{"10:1x"}, "'10:1x' names no factor"},
      {{"99999999999999999999"}, "'99999999999999999999' names no factor"},
      {{7.5}, "'7.5' names no factor"},
      {Json::array(), "edge disable expects the option factors: a list of names"},
      {"10", "edge disable expects the option factors: a list of names"},
  };
  for (const auto& [factors, message] : cases) {
    const auto order = map.ask("edge disable", {{"factors", factors}});
    ASSERT_FALSE(order) << factors;
    EXPECT_EQ(order.error().code, ErrorCode::kUsage);
    EXPECT_THAT(order.error().message, HasSubstr(message));
  }
}

TEST(Order, IsReadBackAndNotesAreNone) {
  const Question question{"edge enable", {{"factors", {"3:0"}}, {"operator", "anna"}}};
  const Order order{"edge enable {\"factors\":[\"3:0\"]}",
                    {{{{"a/\"b\"", ~std::uint64_t{0}, 2}, 3}, FactorChange::kEnable}}};
  const CommandRecord record = to_record(order, question, 9);
  EXPECT_EQ(record.operator_name, "anna");
  const auto read = order_of(record);
  ASSERT_TRUE(read && *read);
  EXPECT_EQ((*read)->asked, order.asked);
  EXPECT_EQ((*read)->edits.at(0).factor, order.edits[0].factor);
  EXPECT_FALSE(*order_of({"anna", "", "the lift was a mirror", 0}));
  for (const char* broken :
       {"{}", R"({"asked":"x"})", R"({"asked":"x","edits":3})", R"({"asked":"x","edits":[[]]})",
        R"({"asked":"x","edits":[["s",1,-2,0,"enable"]]})",
        R"({"asked":"x","edits":[["s",1,2,4294967296,"enable"]]})",
        R"({"asked":"x","edits":[["s",1,2,0,"improve"]]})"}) {
    const auto fault = order_of({"anna", "", broken, 0});
    ASSERT_FALSE(fault) << broken;
    EXPECT_THAT(fault.error().message, HasSubstr("cannot read"));
  }
}

// Names are bytes; what a journal cannot say exactly is not ordered.
TEST(Order, OfAFactorWhoseSourceIsNotUtf8IsRefused) {
  const test::TemporaryFolder folder;
  const auto journal = *Journal::open(folder.file("data"));
  MapHead head;
  std::vector<Transaction> steps = test::drive(2);
  for (std::uint64_t i = 0; i < 2; ++i) {
    steps[i].key = {"\xFF\xFE", 7, i + 1};
    head.apply(steps[i], {1, 0, i + 1});
  }
  const auto order = make_order({"edge disable", {{"factors", {"2:0"}}}}, *journal, head);
  ASSERT_FALSE(order);
  EXPECT_THAT(order.error().message, HasSubstr("not UTF-8"));
}

}  // namespace
}  // namespace cairn
