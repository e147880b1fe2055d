// SPDX-License-Identifier: BSD-3-Clause
// What a loop closer on the ground is told of all robots' keyframes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cairn/core/base64.hpp"
#include "tests/server/live_service.hpp"
#include "tests/server/mapped_room.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class Keyframes : public test::LiveService {
 protected:
  void drive(std::uint64_t steps) {
    for (std::uint64_t i = 0; i < steps; ++i)
      submit(test::mapped_step(test::kLeader, i, [&](const std::string& bytes) {
        ASSERT_TRUE(client_->send_payload(std::string(kRangeScanPayload), bytes));
      }));
    ASSERT_TRUE(test::wait_until([&] { return client_->unstored_payloads() == 0; }));
  }
  Json ask(const Json& options) {
    const Result<std::string> answer = client_->command("keyframes " + options.dump(), 10s);
    EXPECT_TRUE(answer) << answer.error().to_string();
    return answer ? Json::parse(*answer) : Json();
  }
};

TEST_F(Keyframes, AreToldWithTheirScans) {
  start();
  drive(8);
  const Json told = ask({{"from", 0}, {"source", "test"}});
  EXPECT_EQ(told.at("store"), journal_->head().revision.store);
  EXPECT_EQ(told.at("next"), 8);
  EXPECT_EQ(told.at("places"), 8);
  EXPECT_EQ(told.at("closed"), 8) << "the eighth step has a loop";
  EXPECT_TRUE(told.at("waiting").empty());
  ASSERT_EQ(told.at("keyframes").size(), 7u) << "nothing names a scan of the first";
  for (std::uint64_t i = 1; i < 8; ++i) {
    const Json& keyframe = told.at("keyframes")[i - 1];
    EXPECT_EQ(keyframe.at("place"), i);
    EXPECT_EQ(keyframe.at("robot"), test::kLeader);
    EXPECT_EQ(keyframe.at("index"), i);
    EXPECT_EQ(*from_base64(keyframe.at("payloads")[0].get<std::string>()),
              test::room_scan(static_cast<double>(i)));
  }
  EXPECT_EQ(ask({{"source", "somebody else"}}).at("closed"), 0);
}

TEST_F(Keyframes, ComeInPortions) {
  start();
  drive(6);
  std::uint64_t next = 0;
  std::vector<std::uint64_t> places;
  while (next < 6) {
    const Json told = ask({{"from", next}, {"most_bytes", 1}});
    EXPECT_EQ(told.at("keyframes").size(), 1u);
    places.push_back(told.at("keyframes")[0].at("place"));
    EXPECT_GT(told.at("next").get<std::uint64_t>(), next);
    next = told.at("next");
  }
  EXPECT_EQ(places, (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST_F(Keyframes, WaitForTheirScans) {
  start();
  drive(3);
  std::string late;
  submit(test::mapped_step(test::kLeader, 3, [&](const std::string& bytes) { late = bytes; }));
  Json told = ask({{"from", 3}});
  EXPECT_TRUE(told.at("keyframes").empty());
  EXPECT_EQ(told.at("waiting"), Json::array({3}));
  ASSERT_TRUE(client_->send_payload(std::string(kRangeScanPayload), late));
  ASSERT_TRUE(test::wait_until([&] { return client_->unstored_payloads() == 0; }));
  told = ask({{"from", 4}, {"again", {3, 999, -1, "three"}}});
  ASSERT_EQ(told.at("keyframes").size(), 1u);
  EXPECT_EQ(told.at("keyframes")[0].at("place"), 3);
  EXPECT_TRUE(told.at("waiting").empty());
}

TEST_F(Keyframes, OptionsThatNobodyKnowsAreRefused) {
  start();
  const auto answer = client_->command("keyframes {\"robot\":\"kestrel\"}", 10s);
  ASSERT_FALSE(answer);
  EXPECT_NE(answer.error().message.find("keyframes has no option 'robot'"), std::string::npos);
}

}  // namespace
}  // namespace cairn
