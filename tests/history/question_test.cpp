// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/question.hpp"

#include <gtest/gtest.h>

#include "cairn/history/export.hpp"

namespace cairn {
namespace {

TEST(Question, SurvivesTheWayToADaemon) {
  const Question question{"export trajectory",
                          {{"robot", "a \"b\" {c}\n"}, {"limit", 3}, {"live", true}}};
  const auto parsed = Question::parse(question.to_string());
  ASSERT_TRUE(parsed) << parsed.error().to_string();
  EXPECT_EQ(parsed->verb, "export trajectory");
  EXPECT_EQ(parsed->options, question.options);
  EXPECT_EQ(parsed->text("robot"), "a \"b\" {c}\n");
  EXPECT_EQ(parsed->number("limit", 9), 3u);
  EXPECT_TRUE(parsed->flag("live"));
  EXPECT_EQ(Question::parse("settle")->verb, "settle");
}

TEST(Question, TakesOptionsOfAnotherTypeForAbsent) {
  const Question question{"log", {{"limit", -1}, {"from", "three"}, {"source", 7}, {"json", 1}}};
  EXPECT_EQ(question.number("limit", 9), 9u);
  EXPECT_EQ(question.number("from", 1), 1u);
  EXPECT_EQ(question.text("source"), "");
  EXPECT_FALSE(question.flag("json"));
}

TEST(Question, IsRefusedWhereItIsNone) {
  for (const char* text : {"log {", "log {]", "log {\"a\":1} and more", "log {\"a\""}) {
    const auto parsed = Question::parse(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, ErrorCode::kUsage);
  }
  const Question question{"log", {{"limit", 1}, {"newest", 2}}};
  EXPECT_TRUE(question.check_options({"newest", "limit"}));
  EXPECT_TRUE(
      question.check_options({"limit"}).error().message.starts_with("log has no option 'newest'"));
}

// A megabyte of brackets, as somebody on the network may send it.
TEST(Question, EndsNobodyByItsDepth) {
  const std::size_t depth = 500'000;
  const std::string nested = std::string(depth, '[') + std::string(depth, ']');
  const auto deep = Question::parse("log {\"limit\":" + nested + "}");
  ASSERT_TRUE(deep);
  EXPECT_EQ(deep->number("limit", 7), 7u);
  EXPECT_FALSE(Question::parse("log {\"limit\":" + nested));
}

TEST(NamedFiles, TravelAsOneText) {
  const NamedFiles files{{"graph", "line\n[not a header]\n"}, {"empty", ""}, {"ids", "1,2\n"}};
  const std::string text = join_files(files);
  const auto split = split_files(text);
  ASSERT_TRUE(split);
  EXPECT_EQ(*split, files);
  for (const std::string& broken :
       {text.substr(0, text.size() - 1), std::string("no header\n"), std::string()})
    EXPECT_FALSE(split_files(broken));
}

}  // namespace
}  // namespace cairn
