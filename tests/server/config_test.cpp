// SPDX-License-Identifier: BSD-3-Clause
#include "server/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn {
namespace {

using testing::HasSubstr;

TEST(Config, SetsWhatAFileNamesAndLeavesTheRest) {
  DaemonConfig config;
  ASSERT_TRUE(
      read_config_text("network: {domain: 7, profile: radio, interface: wlan0}\n"
                       "solve:\n  after_pause_ms: 50\n"
                       "intake:\n  patience_s: 3\n"
                       "journal: {buffer_mb: 4}\n"
                       "maps: {enabled: false, resolution_m: 0.2, most_mb: 64}\n"
                       "log: {format: json, from: warning}\n",
                       "f", config));
  EXPECT_EQ(config.domain, 7U);
  EXPECT_EQ(config.network.profile, dds::Profile::kRadio);
  EXPECT_EQ(config.network.interface, "wlan0");
  EXPECT_EQ(config.service.solve_after_pause, std::chrono::milliseconds(50));
  EXPECT_EQ(config.service.limits.patience_ns, 3'000'000'000);
  EXPECT_EQ(config.service.limits.held, SequencerLimits{}.held);
  EXPECT_EQ(config.journal_buffer_bytes, 4u << 20);
  EXPECT_FALSE(config.service.maps.enabled);
  EXPECT_EQ(config.service.maps.resolution_m, 0.2);
  EXPECT_EQ(config.service.maps.most_bytes, 64u << 20);
  EXPECT_EQ(config.log_format, LogFormat::kJson);
  EXPECT_EQ(config.log_from, Severity::kWarning);
  EXPECT_TRUE(read_config_text("", "f", config));
  EXPECT_EQ(config.domain, 7U);
}

TEST(Config, IsPrintedAsAFileThatMeansTheSame) {
  DaemonConfig config;
  ASSERT_TRUE(read_config_text("network: {domain: 9}\nintake: {held: 77}\n", "f", config));
  const std::string text = dump_config(config);
  EXPECT_THAT(text, HasSubstr("  domain: 9\n"));
  EXPECT_THAT(text, HasSubstr("  held: 77\n"));
  EXPECT_THAT(text, HasSubstr("  profile: local\n"));
  DaemonConfig again;
  const auto read = read_config_text(text, "f", again);
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(dump_config(again), text);
}

TEST(Config, RefusesWhatItDoesNotKnowAndSaysWhere) {
  const std::pair<std::string, std::string> cases[] = {
      {"networks: {}",
       "f:1:1: unknown section 'networks'; expected: network, solve, thin, jumps, journal, "
       "intake, payloads, maps, log"},
      {"network:\n  domian: 3\n",
       "f:2:3: unknown key 'network.domian'; expected: domain, profile, interface"},
      {"network:\n  domain: 233\n",
       "f:2:11: network.domain is '233'; expected a whole number from 0 to 232"},
      {"network:\n  domain: 1.5\n",
       "f:2:11: network.domain is '1.5'; expected a whole number from 0 to 232"},
      {"network:\n  domain: [1]\n",
       "f:2:11: network.domain is a structure; expected a whole number from 0 to 232"},
      {"network: {profile: lan}", "f:1:20: network.profile is 'lan'; expected one of local, radio"},
      {"network: {domain: 1, domain: 2}", "f:1:22: network.domain is given twice"},
      {"network: 3",
       "f:1:10: the section network has no keys; expected: domain, profile, interface"},
      {"- a",
       "f:1:1: no sections; expected: network, solve, thin, jumps, journal, intake, payloads, "
       "maps, log"},
      {"network: {", "f:1:1: not YAML: end of map flow not found"},
      {"solve: {after_pause_ms: 99999999999999999999}",
       "f:1:25: solve.after_pause_ms is '99999999999999999999'; expected a whole number from 1 to "
       "3600000"},
  };
  for (const auto& [text, message] : cases) {
    DaemonConfig config;
    const auto read = read_config_text(text, "f", config);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().to_string(), message);
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(dump_config(config), dump_config({}));  // nothing half-read
  }
}

}  // namespace
}  // namespace cairn
