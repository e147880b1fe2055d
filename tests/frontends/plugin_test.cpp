// SPDX-License-Identifier: BSD-3-Clause
// Front-ends in shared objects: one that the host loads, and those that it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "frontends/host/plugins.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using test::Process;
using test::ProcessResult;
using testing::HasSubstr;

void expect_refused(const std::string& path, const std::string& why) {
  const auto made = make_frontend(path);
  ASSERT_FALSE(made) << path;
  EXPECT_EQ(made.error().code, ErrorCode::kUsage);
  EXPECT_EQ(made.error().place, path);
  EXPECT_EQ(made.error().message, why);
}

TEST(Plugins, AreRefusedWithWhatIsWrong) {
  const test::TemporaryFolder folder;
  expect_refused(PLUGINS "without_symbol.so",
                 "is no front-end: it exports no cairn_frontend_plugin (frontends/api)");
  expect_refused(PLUGINS "of_version_99.so",
                 "is made for version 99 of the front-end interface; this host has version " +
                     std::to_string(FrontendPlugin::kVersion) + ": compile it anew");
  expect_refused(PLUGINS "without_make.so", "makes no front-end");
  expect_refused(PLUGINS "makes_nothing.so", "makes no front-end");
  expect_refused("/no/such.so",
                 "cannot be loaded: /no/such.so: cannot open shared object file: No such file or "
                 "directory");
  // Not one of the system's folders.
  expect_refused("libc.so",
                 "cannot be loaded: ./libc.so: cannot open shared object file: No such file or "
                 "directory");
  const std::string text = folder.file("text.so");
  std::ofstream(text) << "an honest text, which is a little longer than the header of a program is";
  expect_refused(text, "cannot be loaded: " + text + ": invalid ELF header");
}

// The example, or the one that $CAIRN_FRONTEND names.
TEST(Plugins, RunInTheHostAgainstADaemon) {
  const test::TemporaryFolder folder;
  const std::string domain = std::to_string(test::own_domain());
  Process daemon({CAIRND_BINARY, "--data", folder.file("data"), "--domain", domain});
  const char* const other = std::getenv("CAIRN_FRONTEND");
  const std::vector<std::string> words{
      FRONTEND_BINARY, other != nullptr ? other : PLUGINS "odometry_only.so",
      "--input",       "simulated",
      "--robot",       "kestrel",
      "--spool",       folder.file("spool"),
      "--domain",      domain,
      "--settle"};
  const ProcessResult first = Process(words).wait();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("1691 frames, "));
  EXPECT_THAT(first.out, HasSubstr("settled at "));
  EXPECT_THAT(first.out, testing::Not(HasSubstr(" 0 keyframes")));
  const ProcessResult map =
      Process({CAIRN_BINARY, "export", "map", folder.file("map.pgm"), "--domain", domain}).wait();
  EXPECT_EQ(map.exit_code, 0) << map.err;
  const ProcessResult again = Process(words).wait();
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("1691 frames, 0 keyframes and 0 loop closures "));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
}

}  // namespace
}  // namespace cairn
