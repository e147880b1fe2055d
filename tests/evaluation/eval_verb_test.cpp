// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/datasets.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kReference =
    "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 2 1 0 0 0 0 1\n";
constexpr const char* kEstimate =
    "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 2 2 0 0 0 0 1\n9 9 9 9 0 0 0 1\n";

class Eval : public testing::Test {
 protected:
  std::string reference() const { return folder_.write("reference.txt", kReference); }
  std::string estimate() const { return folder_.write("estimate.txt", kEstimate); }

  TemporaryFolder folder_;
};

TEST_F(Eval, PrintsATableAndWritesTheSameNumbersAsJson) {
  const std::string json_path = folder_.file("out.json");
  const auto run =
      run_cairn({"eval", "ate", reference(), estimate(), "--align", "none", "--json", json_path});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("aligned by none: 4 poses, 1 unmatched"));
  EXPECT_THAT(
      run.out,
      HasSubstr("0.2500000    0.4330127    0.5000000    0.0000000    0.0000000    1.0000000"));
  const auto json = nlohmann::json::parse(read_file(json_path));
  EXPECT_EQ(json["metric"], "ate");
  EXPECT_EQ(json["align"], "none");
  EXPECT_EQ(json["pairs"], 4);
  EXPECT_EQ(json["unmatched"], 1);
  EXPECT_EQ(json["translation"]["rmse"], 0.5);
  EXPECT_EQ(json["rotation"]["max"], 0.0);
}

TEST_F(Eval, JsonOnStandardOutputIsAloneThere) {
  const auto run =
      run_cairn({"eval", "rpe", reference(), estimate(), "--delta", "1", "--json", "-"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["pairs"], 3);
  EXPECT_THAT(run.err, HasSubstr("relative pose error over 1"));
}

TEST_F(Eval, DrawsAPicture) {
  const std::string picture = folder_.file("error.svg");
  EXPECT_EQ(
      run_cairn({"eval", "ate", reference(), estimate(), "--plot", picture, "--quiet"}).exit_code,
      0);
  EXPECT_THAT(read_file(picture), HasSubstr("<svg"));
}

TEST_F(Eval, RefusesBadInputWithItsPlaceAndWritesNothing) {
  const std::string bad = folder_.write("bad.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n");
  const auto run = run_cairn({"eval", "ate", reference(), bad, "--json", folder_.file("out.json")});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("bad.txt:2:1: a TUM line has 8 numbers"));
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_EQ(folder_.file_count(), 2u);
}

TEST_F(Eval, RefusesSpacingsThatAreNone) {
  for (const char* delta : {"", "m", "0", "-1m", "1.5", "10km", "nan", "inf"}) {
    const auto run = run_cairn({"eval", "rpe", reference(), estimate(), "--delta", delta});
    EXPECT_EQ(run.exit_code, 2) << delta << run.err;
  }
  EXPECT_EQ(run_cairn({"eval", "rpe", reference(), estimate(), "--delta", "100m"}).exit_code, 3);
  EXPECT_EQ(run_cairn({"eval", "sideways", reference(), estimate()}).exit_code, 2);
}

TEST_F(Eval, RelationsAreMatchedByStampAndListedFromTheWorst) {
  const std::string truth =
      folder_.write("truth.relations", "0 1 1 0 0 0 0 0\n1 2 1.5 0 0 0 0 0\n2 5 0 0 0 0 0 0\n");
  const std::string json_path = folder_.file("out.json");
  const auto run =
      run_cairn({"eval", "relations", truth, reference(), "--json", json_path, "--worst", "1"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("error of relations: 2 relations, 1 unmatched"));
  EXPECT_THAT(run.out, HasSubstr("truth.relations:2: 0.5000 m, 0.000 deg from 1.000000000 2.0"));
  EXPECT_THAT(run.err, HasSubstr("truth.relations:3: 1 of 3 relations lack a pose in "));
  const auto json = nlohmann::json::parse(read_file(json_path));
  EXPECT_EQ(json["metric"], "relations");
  EXPECT_EQ(json["align"], "none");
  EXPECT_EQ(json["pairs"], 2);
  EXPECT_EQ(json["unmatched"], 1);
  EXPECT_EQ(json["translation"]["mean"], 0.25);
  EXPECT_EQ(json["translation"]["std"], 0.25);
  EXPECT_EQ(json["rotation"]["max"], 0.0);
  EXPECT_EQ(json["worst"][0]["line"], 2);
  EXPECT_EQ(run_cairn({"eval", "relations", truth, reference(), "--strict"}).exit_code, 4);
}

TEST_F(Eval, RelationsThatAllLackAPoseAreNotUsable) {
  const std::string truth = folder_.write("truth.relations", "50 51 1 0 0 0 0 0\n");
  const auto run = run_cairn({"eval", "relations", truth, reference(), "--json", "-"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_TRUE(nlohmann::json::parse(run.out)["translation"]["mean"].is_null());
  EXPECT_THAT(run.err, HasSubstr("no relation has both its poses in "));
  EXPECT_EQ(run_cairn({"eval", "relations", truth, reference(), "--align", "se3"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"eval", "relations", truth, reference(), "--plot", "a.svg"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"eval", "relations", truth, reference(), "--delta", "5"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"eval", "ate", reference(), reference(), "--worst", "5"}).exit_code, 2);
}

TEST_F(Eval, GivesThePublishedNumbersByDefault) {
  CAIRN_REQUIRE_DATASET(truth, "trajectories/KITTI_00_gt.txt");
  CAIRN_REQUIRE_DATASET(orb, "trajectories/KITTI_00_ORB.txt");
  const auto ate = run_cairn({"eval", "ate", truth, orb, "--json", "-"});
  EXPECT_NEAR(nlohmann::json::parse(ate.out)["translation"]["rmse"], 1.3034497, 1e-6);
  const auto rpe = run_cairn({"eval", "rpe", truth, orb, "--json", "-"});
  EXPECT_NEAR(nlohmann::json::parse(rpe.out)["translation"]["rmse"], 0.2262613, 1e-6);
  EXPECT_EQ(nlohmann::json::parse(rpe.out)["pairs"], 353);
}

}  // namespace
