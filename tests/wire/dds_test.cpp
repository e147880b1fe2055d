// SPDX-License-Identifier: BSD-3-Clause
// Over the real middleware, in a domain of this process's own, on the loopback interface only.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "clients/client/dds_link.hpp"
#include "server/dds_transport.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/wire/listeners.hpp"
#include "tests/wire/messages.hpp"

namespace cairn {
namespace {

class Dds : public testing::Test {
 protected:
  static std::uint32_t domain() { return test::own_domain(); }
  static std::unique_ptr<Link> make_link(const std::string& source, std::uint64_t writer) {
    return make_dds_link({.domain = domain()}, {.source = source, .epoch = 5, .writer = writer});
  }

  test::RecordingDaemon daemon_;
  test::RecordingClient client_;
  std::unique_ptr<Transport> transport_ = make_dds_transport({.domain = domain()});
  std::unique_ptr<Link> link_ = make_link("wheels", 77);

  void start() {
    ASSERT_TRUE(transport_->start(daemon_));
    ASSERT_TRUE(link_->start(client_));
  }
  void TearDown() override {
    link_->stop();
    transport_->stop();
    EXPECT_THAT(daemon_.troubles.all(), testing::IsEmpty());
    EXPECT_THAT(client_.troubles.all(), testing::IsEmpty());
  }
};

TEST_F(Dds, CarriesTransactionsInTheOrderOfTheirSequenceAndReceiptsBack) {
  start();
  for (std::uint64_t i = 1; i <= 200; ++i) ASSERT_TRUE(link_->send(test::step("wheels", 5, i)));
  const auto received = daemon_.transactions.wait_for(200);
  ASSERT_EQ(received.size(), 200u);
  for (std::uint64_t i = 0; i < 200; ++i) EXPECT_EQ(received[i].first.key.sequence, i + 1);
  EXPECT_EQ(received[0].second.writer, 77u);
  EXPECT_EQ(received[9].first.factors[0].payloads[1], content_hash("scan b"));
  EXPECT_EQ(received[9].first.factors[0].nodes, test::step("wheels", 5, 10).factors[0].nodes);

  transport_->publish_receipts({{.key = {"sonar", 5, 1}, .revision = {9, 0, 1}}});
  transport_->publish_receipts({{.key = {"wheels", 6, 1}, .revision = {9, 0, 2}}});
  transport_->publish_receipts({{.key = {"wheels", 5, 1}, .revision = {9, 0, 3}}});
  const auto receipts = client_.receipts.wait_for(1);
  ASSERT_EQ(receipts.size(), 1u);  // its own only
  EXPECT_EQ(receipts[0].revision.number, 3u);
}

TEST_F(Dds, KeepsTheWindowOfAClientForADaemonThatComesLater) {
  ASSERT_TRUE(link_->start(client_));
  for (std::uint64_t i = 1; i <= 256; ++i) ASSERT_TRUE(link_->send(test::step("wheels", 5, i)));
  ASSERT_TRUE(transport_->start(daemon_));
  EXPECT_EQ(daemon_.transactions.wait_for(256).size(), 256u);
}

TEST_F(Dds, TellsThatAClientCameAndThatItWent) {
  start();
  auto other = make_link("wheels", 78);
  test::RecordingClient other_client;
  ASSERT_TRUE(other->start(other_client));
  ASSERT_TRUE(link_->send(ClientState{.source = "wheels", .epoch = 5, .robot = "r"}));
  ASSERT_TRUE(other->send(ClientState{.source = "wheels", .epoch = 5, .robot = "r"}));
  EXPECT_EQ(daemon_.clients.wait_for(2).size(), 2u);
  other.reset();  // one of two with the same name
  const auto lost = daemon_.lost.wait_for(1);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].first, "wheels");
  EXPECT_EQ(lost[0].second.writer, 78u);
}

TEST_F(Dds, ForgetsWhatItSaidToASpoolThatIsGone) {
  ASSERT_TRUE(transport_->start(daemon_));
  for (std::uint64_t i = 1; i <= 20; ++i)
    transport_->publish_receipts({{.key = {"wheels", 5, i}, .revision = {9, 0, i}}});
  for (std::uint64_t i = 1; i <= 20; ++i)
    transport_->publish(PayloadReceipt{.source = "wheels", .epoch = 5, .number = i});
  transport_->publish(SourceState{.source = "wheels", .epoch = 5, .highest_decided = 4});
  transport_->publish(SourceState{.source = "sonar", .epoch = 5, .highest_decided = 4});
  transport_->forget("wheels", 5);
  auto other = make_link("sonar", 78);
  test::RecordingClient other_client;
  ASSERT_TRUE(other->start(other_client));
  ASSERT_TRUE(link_->start(client_));
  EXPECT_EQ(other_client.source_states.wait_for(1).size(), 1u);
  transport_->publish(SourceState{.source = "wheels", .epoch = 5, .highest_decided = 6});
  EXPECT_EQ(client_.source_states.wait_for(1).at(0).highest_decided, 6u);
  EXPECT_THAT(client_.receipts.all(), testing::IsEmpty());
  EXPECT_THAT(client_.payload_receipts.all(), testing::IsEmpty());
  EXPECT_EQ(client_.source_states.all().size(), 1u);
}

TEST_F(Dds, DeliversWholeRoundsAndTheNewestChunksToLateComers) {
  ASSERT_TRUE(transport_->start(daemon_));
  transport_->publish_poses(test::revisions(1, 0),
                            {test::chunk("a", 0, 256), test::chunk("a", 1, 9)});
  transport_->publish_poses(test::revisions(3, 2), {test::chunk("a", 1, 10)});
  ASSERT_TRUE(link_->start(client_));
  auto rounds = client_.poses.wait_for(1);
  ASSERT_EQ(rounds.size(), 1u);
  EXPECT_EQ(rounds[0].first, test::revisions(3, 2));
  ASSERT_EQ(rounds[0].second.size(), 2u);
  EXPECT_EQ(rounds[0].second[1], test::chunk("a", 1, 10));
  transport_->publish_poses(test::revisions(4, 2), {});  // nothing moved, but the revision did
  rounds = client_.poses.wait_for(2);
  ASSERT_EQ(rounds.size(), 2u);
  EXPECT_EQ(rounds[1].first, test::revisions(4, 2));
  EXPECT_TRUE(rounds[1].second.empty());
}

TEST_F(Dds, AnswersCommandsWithRepliesOfAnySize) {
  start();
  ASSERT_TRUE(link_->send(Command{.key = {77, 1}, .text = "status"}, 5000));
  const auto commands = daemon_.commands.wait_for(1);
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands[0].text, "status");
  const std::string text(3'500'000, 'x');
  transport_->reply({.key = {99, 1}, .text = "somebody else's"});
  transport_->reply({.key = {77, 1}, .text = text});
  transport_->reply({.key = {77, 2}, .error = ErrorCode::kBadInput, .text = "no such verb"});
  const auto replies = client_.replies.wait_for(2);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0].text, text);
  EXPECT_EQ(replies[1].error, ErrorCode::kBadInput);
}

TEST_F(Dds, CarriesTheRest) {
  start();
  Payload scan{.source = "wheels", .epoch = 5, .number = 1, .hash = content_hash("z")};
  scan.type = "laser_scan/1";
  scan.bytes.assign(2'000'000, 'z');
  transport_->publish(SourceState{.source = "wheels", .epoch = 5, .highest_decided = 4});
  transport_->publish(Correction{.frame = {"a", 1}, .jump_m = 0.5});
  ASSERT_EQ(client_.source_states.wait_for(1).size(), 1u);
  ASSERT_EQ(client_.corrections.wait_for(1).size(), 1u);
  ASSERT_TRUE(link_->send(Command{.key = {77, 1}, .text = "x"}, 5000));  // both see each other
  ASSERT_EQ(daemon_.commands.wait_for(1).size(), 1u);
  ASSERT_TRUE(link_->send(scan));
  ASSERT_EQ(daemon_.payloads.wait_for(1).size(), 1u);
  EXPECT_EQ(daemon_.payloads.all()[0].bytes, scan.bytes);
  Event event;
  event.kind = "damage";
  transport_->publish(event);
  EXPECT_EQ(client_.events.wait_for(1).size(), 1u);
}

TEST_F(Dds, SeesAnotherDaemonOfTheDomain) {
  start();
  auto second = make_dds_transport({.domain = domain()});
  test::RecordingDaemon second_daemon;
  ASSERT_TRUE(second->start(second_daemon));
  Status status;
  status.started_ns = 1;
  transport_->publish(status);
  const auto rivals = second_daemon.rivals.wait_for(1);
  ASSERT_EQ(rivals.size(), 1u);
  EXPECT_EQ(rivals[0].started_ns, 1);
  second->stop();
  EXPECT_THAT(daemon_.rivals.all(), testing::IsEmpty());  // itself is none
}

TEST_F(Dds, SaysWhatIsWrongWithADomainThatCannotBe) {
  const auto impossible = make_dds_transport({.domain = 1000});
  const auto started = impossible->start(daemon_);
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message, "domain is 1000; expected 0 to 230");
}

}  // namespace
}  // namespace cairn
