// SPDX-License-Identifier: BSD-3-Clause
// The example of backend/maps/README.md.
#include <gtest/gtest.h>

#include <random>

#include "cairn/maps/map_image.hpp"
#include "cairn/maps/map_renderer.hpp"
#include "tests/maps/slow_map.hpp"

namespace cairn {
namespace {

TEST(Readme, ExampleDrawsAMap) {
  std::mt19937 random(1);
  const std::vector<std::shared_ptr<const RangeScan>> scans{
      std::make_shared<RangeScan>(test::random_scan(random)),
      std::make_shared<RangeScan>(test::random_scan(random))};
  const ScanSource scan_of = [&](ScanId id) { return scans[id]; };

  LaserMap map(0.05);
  const std::vector<PlacedScan> placed{{0, Se2(0.0, 0.0, 0.0)}, {1, Se2(0.8, 0.1, 0.2)}};
  const RenderReport report = map.render(placed, scan_of, Precision::kTolerant);
  const Result<MapImage> image = draw_map(map.grid(), map.resolution_m(), MapModel::kOccupancy);

  EXPECT_EQ(report.added, 2u);
  ASSERT_TRUE(image.ok()) << image.error().to_string();
  EXPECT_GT(image->width, 100u);
}

}  // namespace
}  // namespace cairn
