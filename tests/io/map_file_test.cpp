// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/map_file.hpp"

#include <gtest/gtest.h>

#include "cairn/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

constexpr CellState kU = CellState::kUnknown, kF = CellState::kFree, kO = CellState::kOccupied;

MapImage some_map() { return {0.05, Se2(-1.25, 3.1, 0.5), 3, 2, {kO, kF, kU, kF, kF, kO}}; }

constexpr const char* kYaml =
    "image: map.pgm\nresolution: 0.05\norigin: [-1.25, 3.1, 0.5]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::string yaml_error(const std::string& text) {
  const auto yaml = read_map_yaml(text, "map.yaml");
  return yaml ? "accepted" : yaml.error().to_string();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string pgm_error(const std::string& bytes) {
  const auto map = read_pgm(bytes, "map.pgm", *read_map_yaml(kYaml, "map.yaml"));
  return map ? "accepted" : map.error().to_string();
}

TEST(MapFile, WritesTheUpperRowFirst) {
  EXPECT_EQ(write_pgm(some_map()), std::string("P5\n3 2\n255\n\xfe\xfe\0\0\xfe\xcd", 17));
  EXPECT_EQ(*write_map_yaml(some_map(), "map.pgm"), std::string(kYaml) + "mode: trinary\n");
}

TEST(MapFile, IsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  const MapImage map = some_map();
  for (const std::string name : {"map.pgm", "m \"a\" #1.pgm"}) {
    ASSERT_TRUE(write_file(folder.file(name), write_pgm(map)));
    ASSERT_TRUE(write_file(folder.file("map.yaml"), *write_map_yaml(map, name)));
    const Result<MapImage> read = read_map(folder.file("map.yaml"));
    ASSERT_TRUE(read.ok()) << read.error().to_string();
    EXPECT_EQ(read->cells, map.cells);
    EXPECT_EQ(read->width, 3u);
    EXPECT_EQ(read->resolution_m, 0.05);
    EXPECT_EQ(read->T_map_image.to_vector(), map.T_map_image.to_vector());
  }
  EXPECT_EQ(write_map_yaml(map, "a\nb.pgm").error().code, ErrorCode::kUsage);
}

TEST(MapFile, ReadsWhatOthersWrite) {
  const std::string text =
      "---\n# a map\nimage: 'm.pgm'  # beside\nresolution: 5.0e-2\r\n"
      "origin: [-1, 2.5,0]\nmode: scale\nauthor: somebody\nnegate: 1\n"
      "occupied_thresh: 0.9\nfree_thresh: 0.1\n";
  const Result<MapYaml> yaml = read_map_yaml(text, "map.yaml");
  ASSERT_TRUE(yaml.ok()) << yaml.error().to_string();
  EXPECT_EQ(yaml->image, "m.pgm");
  EXPECT_TRUE(yaml->negate);
  const auto map = read_pgm("P2 # plain\n2 2\n# levels\n100\n0 50\n95 5\n", "m.pgm", *yaml);
  ASSERT_TRUE(map.ok()) << map.error().to_string();
  EXPECT_EQ(map->cells, (std::vector<CellState>{kO, kF, kF, kU}));
}

TEST(MapFile, TellsWhatIsWrongWithAYamlFile) {
  EXPECT_EQ(yaml_error("image map.pgm\n"), "map.yaml:1:1: expected `key: value`");
  EXPECT_EQ(yaml_error(replaced(kYaml, "0.05", "-1")),
            "map.yaml:2:13: resolution expects meters per pixel, from 0.0001 to 1000");
  EXPECT_EQ(yaml_error(replaced(kYaml, "0.05", "nan")),
            "map.yaml:2:13: resolution expects meters per pixel, from 0.0001 to 1000");
  EXPECT_EQ(yaml_error(replaced(kYaml, ", 0.5", "")),
            "map.yaml:3:9: origin expects [x, y, yaw] of the lower left corner, m and rad");
  EXPECT_EQ(yaml_error(replaced(kYaml, "negate: 0", "negate: 2")),
            "map.yaml:4:9: negate expects 0 or 1");
  EXPECT_EQ(yaml_error(replaced(kYaml, "image: map.pgm", "image:")),
            "map.yaml:1:1: image expects the name of a picture");
  EXPECT_EQ(yaml_error(std::string(kYaml) + "mode: raw\n"),
            "map.yaml:7:7: mode expects trinary or scale (raw maps cannot be read)");
  EXPECT_EQ(yaml_error(std::string(kYaml) + "negate: 0\n"),
            "map.yaml:7:1: negate stands here a second time");
  EXPECT_EQ(yaml_error(replaced(kYaml, "negate: 0\n", "")),
            "map.yaml: the key negate is missing; expected 0 or 1");
  EXPECT_EQ(yaml_error(replaced(kYaml, "0.196", "0.7")),
            "map.yaml: free_thresh is above occupied_thresh; expected the reverse");
}

TEST(MapFile, TellsWhatIsWrongWithAPgmFile) {
  const std::string sound = write_pgm(some_map());
  EXPECT_EQ(pgm_error("\x89PNG"),
            "map.pgm: byte 0: expected a PGM file, which begins with P5 or P2; convert the image "
            "to PGM");
  EXPECT_EQ(pgm_error("P5\n3 x"),
            "map.pgm: byte 5: expected width, height and the number of the brightest gray level");
  EXPECT_EQ(pgm_error("P5\n3 2\n65535\n"),
            "map.pgm: byte 12: the brightest gray level is 65535; expected 1 to 255");
  EXPECT_EQ(pgm_error("P5\n1000000000 1000000000\n255\n"),
            "map.pgm: byte 29: ends too early for 1000000000 x 1000000000 pixels");
  EXPECT_EQ(pgm_error(sound.substr(0, sound.size() - 1)),
            "map.pgm: byte 16: pixel 5 of 6 is no gray level up to 255");
  EXPECT_EQ(pgm_error("P2\n2 1\n100\n7 101\n"),
            "map.pgm: byte 12: pixel 1 of 2 is no gray level up to 100");
  for (std::size_t size = 0; size < sound.size(); ++size)
    EXPECT_NE(pgm_error(sound.substr(0, size)), "accepted") << size;
}

}  // namespace
}  // namespace cairn
