// SPDX-License-Identifier: BSD-3-Clause
// What every front-end must do, whatever it does: the contract of frontends/api/frontend.hpp. Those
// built in, the example of a plug-in, and the one whose shared object $CAIRN_FRONTEND names.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>

#include "frontends/host/plugins.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/frontends/recording_context.hpp"

namespace cairn {
namespace {

using test::RecordingContext;

std::vector<std::string> frontends() {
  std::vector<std::string> all{"laser", PLUGINS "odometry_only.so"};
  if (const char* more = std::getenv("CAIRN_FRONTEND")) all.emplace_back(more);
  return all;
}

const std::vector<LaserScan>& whole_drive() {
  static const SimulatedDrive drive = simulate_drive();
  return drive.scans;
}
std::vector<LaserScan> half_a_minute() {
  return {whole_drive().begin(), whole_drive().begin() + 300};
}

using Between = std::function<void(Frontend&, std::size_t)>;

class FrontendContract : public testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<Frontend> make() {
    auto made = make_frontend(GetParam());
    if (!made) throw std::runtime_error(made.error().to_string());
    return std::move(*made);
  }
  // From start to stop, with `between` after each scan.
  static void run(RecordingContext& context, const std::vector<LaserScan>& scans,
                  const Between& between = {}) {
    const std::unique_ptr<Frontend> frontend = make();
    expect_done(frontend->start(context));
    EXPECT_TRUE(context.frames.empty() && context.keyframes.empty());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      expect_done(context.process(*frontend, scans[i]));
      if (between) between(*frontend, i);
    }
    expect_done(frontend->stop());
  }
  static void expect_done(const Result<void>& result) {
    EXPECT_TRUE(result) << result.error().to_string();
  }
};

std::vector<std::string> bytes_of(const std::vector<Transaction>& all, std::size_t from = 0) {
  std::vector<std::string> bytes;
  for (std::size_t i = from; i < all.size(); ++i) bytes.push_back(encode(all[i]));
  return bytes;
}

void expect_same_places(const RecordingContext& a, const RecordingContext& b) {
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].keyframe, b.frames[i].keyframe) << i;
    EXPECT_EQ(a.frames[i].T_keyframe_body.to_vector(), b.frames[i].T_keyframe_body.to_vector())
        << i;
  }
}

TEST_P(FrontendContract, SendsWhatTheDaemonAcceptsAndTheSameBitsAgain) {
  std::vector<std::string> first;
  for (int round = 0; round < 2; ++round) {
    RecordingContext context;
    run(context, whole_drive(), [&](Frontend& frontend, std::size_t i) {
      if (i % 100 == 99) frontend.on_snapshot(context.snapshot());
    });
    EXPECT_EQ(context.frames.size(), whole_drive().size());
    EXPECT_GT(context.keyframes.size(), 100u);
    auto bytes = bytes_of(context.keyframes);
    for (std::string& loop : bytes_of(context.loops)) bytes.push_back(std::move(loop));
    if (round == 0) first = bytes;
    EXPECT_TRUE(bytes == first);
  }
}

TEST_P(FrontendContract, AsATrackerFindsNoLoops) {
  RecordingContext context(FrontendRoles{.loop_closer = false});  // which counts them as failures
  run(context, whole_drive());
  EXPECT_GT(context.keyframes.size(), 100u);
}

TEST_P(FrontendContract, SendsTheRestWhereARunBeforeHasStopped) {
  RecordingContext first;
  run(first, whole_drive());
  const std::size_t count = first.keyframes.size();
  for (const std::size_t before : {std::size_t{1}, std::size_t{2}, count / 2, count - 1, count}) {
    SCOPED_TRACE("keyframes before: " + std::to_string(before));
    RecordingContext second(first, before);
    run(second, whole_drive());
    EXPECT_TRUE(bytes_of(second.keyframes) == bytes_of(first.keyframes, before));
    expect_same_places(second, first);
    const auto all = bytes_of(first.loops);
    ASSERT_LE(second.loops.size(), all.size()) << "loops that were sent before";
    EXPECT_TRUE(bytes_of(second.loops) == bytes_of(first.loops, all.size() - second.loops.size()));
  }
}

TEST_P(FrontendContract, TakesStampsAsLabels) {
  RecordingContext plain;
  run(plain, half_a_minute());
  const std::vector<std::function<std::int64_t(std::int64_t, std::size_t)>> clocks{
      [](std::int64_t stamp, std::size_t i) { return i % 5 == 4 ? stamp - 1'900'000'000 : stamp; },
      [](std::int64_t stamp, std::size_t i) { return i % 2 == 1 ? stamp - 100'000'000 : stamp; },
      [](std::int64_t, std::size_t) { return std::int64_t{0}; },
      [](std::int64_t, std::size_t i) {
        return i < 100 ? -5 : std::numeric_limits<std::int64_t>::max();
      }};
  for (std::size_t clock = 0; clock < clocks.size(); ++clock) {
    SCOPED_TRACE("clock " + std::to_string(clock));
    auto scans = half_a_minute();
    for (std::size_t i = 0; i < scans.size(); ++i)
      scans[i].stamp_ns = clocks[clock](scans[i].stamp_ns, i);
    RecordingContext context;
    run(context, scans);
    expect_same_places(context, plain);
    ASSERT_EQ(context.keyframes.size(), plain.keyframes.size());
    for (std::size_t k = 0; k < plain.keyframes.size(); ++k)
      context.keyframes[k].variables[0].stamp_ns = plain.keyframes[k].variables[0].stamp_ns;
    EXPECT_TRUE(bytes_of(context.keyframes) == bytes_of(plain.keyframes));
  }
}

// Each kind as the first scan, as keyframes in the middle, and all of them in turn.
TEST_P(FrontendContract, LocalizesScansThatSayNothing) {
  const auto fill = [](float range) {
    return [range](LaserScan& scan) {
      for (float& r : scan.ranges_m) r = range;
    };
  };
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<std::function<void(LaserScan&)>> kinds{
      fill(NAN),
      fill(inf),
      fill(-inf),
      fill(0.0F),
      fill(-1.0F),
      fill(12.0F),
      fill(1e30F),
      fill(0.2F),
      [](LaserScan& scan) { scan.ranges_m.clear(); },
      [](LaserScan& scan) { scan.ranges_m.resize(1); },
      [](LaserScan& scan) { scan.ranges_m.resize(2); },
      [](LaserScan& scan) { scan.T_odom_laser.reset(); }};
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    SCOPED_TRACE("kind " + std::to_string(kind));
    auto scans = half_a_minute();
    for (std::size_t i = 0; i < scans.size(); ++i)
      if (i == 0 || (i > 60 && i < 160) || i % 3 == 0) kinds[kind](scans[i]);
    for (std::size_t i = 200; i < scans.size(); ++i) kinds[i % kinds.size()](scans[i]);
    RecordingContext context;
    run(context, scans);
    EXPECT_EQ(context.frames.size(), scans.size());
  }
}

// What snapshots say has no part in keyframes: a run that goes on after another makes them again,
// and hears other snapshots.
TEST_P(FrontendContract, MakesTheSameKeyframesWhateverSnapshotsSay) {
  RecordingContext plain;
  run(plain, half_a_minute());
  constexpr std::uint64_t kFar = std::numeric_limits<std::uint64_t>::max();
  const PoseNumbers in_space{1, 2, 3, 0, 0, 0, 1};
  RecordingContext context;
  const auto poses = [&](const OdometryFrame& frame, VariableType type, std::uint64_t index) {
    return PoseChunk{frame, 0, "m", type, {{index, 0, in_space}}};
  };
  run(context, half_a_minute(), [&](Frontend& frontend, std::size_t i) {
    frontend.on_snapshot({});
    MapSnapshot told;
    for (const VariableType type : {VariableType::kPose2, VariableType::kPose3})
      for (const std::uint64_t index : {std::uint64_t{0}, std::uint64_t{5}, i + 1, kFar - 1, kFar})
        for (const OdometryFrame& frame :
             {context.frame, OdometryFrame{"other", 7}, OdometryFrame{"robot", 8}})
          told.changed.push_back(poses(frame, type, index));
    told.changed.push_back({context.frame, 3, "m", VariableType::kPose2, {}});
    frontend.on_snapshot(told);
    frontend.on_snapshot(context.snapshot());
  });
  EXPECT_TRUE(bytes_of(context.keyframes) == bytes_of(plain.keyframes));
  expect_same_places(context, plain);
}

// An epoch has a front-end of its own, and a process may have several robots' one day.
TEST_P(FrontendContract, KnowsNothingOfOthersOfItsKind) {
  RecordingContext plain, one, other;
  run(plain, half_a_minute());
  other.frame = {"other", 8};
  const auto a = make(), b = make();
  expect_done(a->start(one));
  expect_done(b->start(other));
  const auto scans = half_a_minute();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    expect_done(other.process(*b, scans[scans.size() - 1 - i]));
    expect_done(one.process(*a, scans[i]));
  }
  expect_done(b->stop());
  expect_done(a->stop());
  EXPECT_TRUE(bytes_of(one.keyframes) == bytes_of(plain.keyframes));
}

TEST_P(FrontendContract, StopsAlsoWhereNothingCameAndOutlivesItsContext) {
  const auto frontend = make();
  {
    RecordingContext context;
    expect_done(frontend->start(context));
    expect_done(frontend->stop());
    EXPECT_TRUE(context.frames.empty() && context.keyframes.empty() && context.loops.empty());
  }
}

TEST_P(FrontendContract, TellsWhatTheHostCannotTake) {
  RecordingContext context;
  const auto frontend = make();
  expect_done(frontend->start(context));
  const auto scans = half_a_minute();
  for (std::size_t i = 0; i < 50; ++i) expect_done(context.process(*frontend, scans[i]));
  context.refuses = true;
  Result<void> told;
  for (std::size_t i = 50; i < scans.size() && told; ++i) told = frontend->process(scans[i]);
  if (told) told = frontend->stop();
  ASSERT_FALSE(told) << "it goes on as if its keyframes were safe";
  EXPECT_EQ(told.error().message, "the disk of the spool is full");
}

INSTANTIATE_TEST_SUITE_P(Of, FrontendContract, testing::ValuesIn(frontends()),
                         [](const auto& front_end) {
                           return front_end.index == 2
                                      ? "env"
                                      : std::filesystem::path(front_end.param).stem().string();
                         });

}  // namespace
}  // namespace cairn
