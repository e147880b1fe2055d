// SPDX-License-Identifier: BSD-3-Clause
// From a data folder to a map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cairn/io/map_file.hpp"
#include "cairn/maps/range_scan.hpp"
#include "tests/cli/data_folder.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace cairn::test;
using testing::HasSubstr;

// What a laser sees at (x, 0), looking along x, of a room from (-3, -4) to (33, 4).
std::string scan_at(double x) {
  constexpr double kStep = 0.01745329251994;
  RangeScan scan{-180 * kStep, kStep, 60.0, Se2(), {}};
  for (int i = 0; i < 360; ++i) {
    const double angle = scan.first_angle_rad + i * kStep;
    const double to_x = (std::cos(angle) > 0 ? 33.0 - x : -3.0 - x) / std::cos(angle);
    const double to_y = (std::sin(angle) > 0 ? 4.0 : -4.0) / std::sin(angle);
    scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return *encode(scan);
}

// A drive of 30 poses along the room. The second step brings the scans of the first two poses, the
// others one each; that of the last pose never comes, and pose 5 has an image, too.
class ExportMap : public testing::Test {
 protected:
  void SetUp() override {
    DataFolderMaker maker(folder_.file("data"));
    std::vector<Transaction> steps = drive(30);
    for (std::size_t i = 1; i < steps.size(); ++i) {
      auto& payloads = steps[i].factors.front().payloads;
      const auto scan = scan_at(static_cast<double>(i));
      if (i == 1) payloads.push_back(maker.put_payload(scan_at(0.0)));
      payloads.push_back(i == 29 ? content_hash(scan) : maker.put_payload(scan));
      if (i == 5) {
        steps[i].factors.push_back(steps[i].factors.front());
        steps[i].factors.back().payloads = {maker.put_payload("an image")};
      }
    }
    maker.submit_all(steps);
    maker.solve();
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] ProcessResult run(std::vector<std::string> words) const {
    words.insert(words.begin(), {"export", "map"});
    words.insert(words.end(), {"--data", folder_.file("data")});
    return run_cairn(words);
  }
  [[nodiscard]] MapImage map(const std::string& yaml) const {
    const Result<MapImage> read = read_map(file(yaml));
    EXPECT_TRUE(read.ok()) << read.error().to_string();
    return read.ok() ? *read : MapImage();
  }
  // Of the point (x, y).
  static CellState at(const MapImage& map, double x, double y) {
    const Eigen::Vector2d p =
        (map.T_map_image.inverse() * Eigen::Vector2d(x, y)) / map.resolution_m;
    return map.at(static_cast<std::size_t>(p.x()), static_cast<std::size_t>(p.y()));
  }

  TemporaryFolder folder_;
};

TEST_F(ExportMap, ShowsTheRoom) {
  const auto exported = run({file("room.pgm"), "--resolution", "0.5"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("cells of 29 scans"));
  EXPECT_THAT(exported.err, HasSubstr("1 scans that keyframes name have not come"));
  const MapImage room = map("room.yaml");
  EXPECT_EQ(room.resolution_m, 0.5);
  for (const double x : {2.0, 10.0, 20.0, 28.0}) {
    EXPECT_EQ(at(room, x, 0.0), CellState::kFree) << x;
    // The drive is noisy: the wall is within a cell of where it was.
    EXPECT_TRUE(at(room, x, 4.1) == CellState::kOccupied ||
                at(room, x, 3.6) == CellState::kOccupied)
        << x;
  }
  EXPECT_NEAR(room.T_map_image.x(), -3.0, 1.1);
  EXPECT_NEAR(static_cast<double>(room.width) * 0.5, 36.0, 2.1);
}

TEST_F(ExportMap, WritesPngYamlAndPicture) {
  const auto exported =
      run({file("a.png"), "--model", "reflection", "--picture", file("seen.png")});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(read_file(file("a.png")).substr(1, 3), "PNG");
  EXPECT_EQ(read_file(file("seen.png")).substr(1, 3), "PNG");
  EXPECT_THAT(read_file(file("a.yaml")), HasSubstr("image: a.png\nresolution: 0.05\n"));
  EXPECT_EQ(run({file("b.yaml"), "--quiet"}).out, "");
  EXPECT_THAT(read_file(file("b.yaml")), HasSubstr("image: b.pgm\n"));
}

TEST_F(ExportMap, IsTheSameForEachCall) {
  ASSERT_EQ(run({file("a.pgm")}).exit_code, 0);
  ASSERT_EQ(run({file("b.pgm")}).exit_code, 0);
  EXPECT_EQ(read_file(file("a.pgm")), read_file(file("b.pgm")));
}

TEST_F(ExportMap, OfADaemonIsThatOfItsFolder) {
  ASSERT_EQ(run({file("folder.pgm")}).exit_code, 0);
  const std::string domain = std::to_string(own_domain());
  Process daemon({CAIRND_BINARY, "--data", folder_.file("data"), "--domain", domain});
  const auto exported = run_cairn({"export", "map", file("daemon.pgm"), "--picture",
                                   file("seen.svg"), "--domain", domain, "--timeout", "20"});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
  EXPECT_EQ(read_file(file("daemon.pgm")), read_file(file("folder.pgm")));
  EXPECT_THAT(read_file(file("seen.svg")), HasSubstr("<svg"));
}

TEST_F(ExportMap, RefusesWhatMakesNoSenseAndWritesNothing) {
  const std::size_t before = folder_.file_count();
  EXPECT_EQ(run({file("a.txt")}).exit_code, 2);
  EXPECT_EQ(run({file("a.pgm"), "--resolution", "0.001"}).exit_code, 2);
  EXPECT_EQ(run({file("a.pgm"), "--model", "magic"}).exit_code, 2);
  EXPECT_EQ(run({file("a.pgm"), "--picture", file("a.pgm")}).exit_code, 2);
  const auto unknown = run({file("a.pgm"), "--robot", "nobody"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("there is no robot 'nobody' with poses; there are: robot"));
  EXPECT_EQ(folder_.file_count(), before);
}

TEST_F(ExportMap, NeedsScans) {
  const TemporaryFolder other;
  {
    DataFolderMaker maker(other.file("data"));
    maker.submit_all(drive(3));
  }
  const auto exported = run_cairn({"export", "map", file("a.pgm"), "--data", other.file("data")});
  EXPECT_EQ(exported.exit_code, 4);
  EXPECT_THAT(exported.err, HasSubstr("no pose of this map has a laser scan"));
}

}  // namespace
