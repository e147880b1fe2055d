// SPDX-License-Identifier: BSD-3-Clause
// A daemon's live map on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/data_folder.hpp"
#include "tests/server/mapped_room.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace cairn::test;
using testing::HasSubstr;

class LiveMap : public testing::Test {
 protected:
  void SetUp() override {
    DataFolderMaker maker(folder_.file("data"));
    for (std::uint64_t i = 0; i < 10; ++i)
      maker.submit(
          mapped_step(kLeader, i, [&](const std::string& scan) { maker.put_payload(scan); }));
    maker.solve();
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] ProcessResult run(std::vector<std::string> words) const {
    words.insert(words.end(), {"--domain", domain_, "--timeout", "20"});
    return run_cairn(words);
  }

  TemporaryFolder folder_;
  std::string domain_ = std::to_string(own_domain());
};

TEST_F(LiveMap, IsThatOfExportMapToTheBit) {
  Process daemon({CAIRND_BINARY, "--data", file("data"), "--domain", domain_});
  const auto live = run({"map", file("live.pgm")});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.out, HasSubstr("live.pgm: map robot/3: "));
  EXPECT_THAT(live.out, HasSubstr("in cells of 0.05 m"));
  ASSERT_EQ(run({"export", "map", file("export.pgm")}).exit_code, 0);
  EXPECT_EQ(read_file(file("live.pgm")), read_file(file("export.pgm")));
  EXPECT_THAT(read_file(file("live.yaml")), HasSubstr("image: live.pgm"));
  const auto drawn = run({"map"});
  EXPECT_EQ(drawn.exit_code, 0);
  EXPECT_THAT(drawn.out, HasSubstr("#"));
  EXPECT_THAT(drawn.out, HasSubstr("."));
  const auto wrong = run({"map", "--map", "nobody/1"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("there is no map 'nobody/1'; those there are: robot/3"));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
}

TEST_F(LiveMap, SaysWhyThereIsNone) {
  EXPECT_EQ(run_cairn({"map", file("a.bmp")}).exit_code, 2);
  const auto nobody = run_cairn({"map", "--domain", domain_, "--timeout", "0.2"});
  EXPECT_EQ(nobody.exit_code, 5) << nobody.err;
  Process empty({CAIRND_BINARY, "--data", file("empty"), "--domain", domain_});
  const auto none = run({"map", file("a.pgm")});
  EXPECT_EQ(none.exit_code, 4);
  EXPECT_THAT(none.err, HasSubstr("no keyframe of this map has a laser scan yet"));
  EXPECT_FALSE(std::filesystem::exists(file("a.pgm")));
  empty.send(SIGTERM);
  EXPECT_EQ(empty.wait().exit_code, 0);
}

}  // namespace
