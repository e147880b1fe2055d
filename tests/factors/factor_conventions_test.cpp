// SPDX-License-Identifier: BSD-3-Clause
// What each measurement means: values worked out by hand, and behavior where a measurement
// degenerates.
#include "tests/factors/random_factors.hpp"
#include "tests/support/matrix_matchers.hpp"

namespace cairn::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr ErrorChart kG2o = ErrorChart::kG2o;

Se3 turned_about_z(double angle_rad, const Eigen::Vector3d& t) {
  return {So3::exp({0.0, 0.0, angle_rad}), t};
}

TEST(PriorSe3, MeasuresTheSensorNotTheBody) {
  PriorSe3 factor;
  factor.sensor.T_body_sensor = turned_about_z(0.5 * kPi, {1.0, 2.0, 3.0});
  const Se3 T_map_body = turned_about_z(0.3, {4.0, 5.0, 6.0});
  factor.T_map_sensor_measured = T_map_body * factor.sensor.T_body_sensor;
  EXPECT_THAT(factor.error(T_map_body, kG2o, nullptr), is_near(Vector6d::Zero(), 1e-14));
}

TEST(BetweenOffsetSe2, MeasuresFromSensorToSensor) {
  BetweenOffsetSe2 factor;
  factor.sensor_a.T_body_sensor = Se2(1.0, 0.0, 0.5 * kPi);          // on the nose, looking left
  factor.sensor_b.T_body_sensor = Se2(-1.0, 0.0, 0.0);               // on the tail, looking ahead
  factor.T_sensor_a_sensor_b_measured = Se2(0.0, -3.0, -0.5 * kPi);  // 3 m to the right of a's view
  factor.information.setIdentity();
  // So the tail of b is at x = 4, and b itself at x = 5.
  EXPECT_THAT(factor.error(Se2(), Se2(5.0, 0.0, 0.0), kG2o, nullptr, nullptr),
              is_near(Eigen::Vector3d::Zero(), 1e-14));
  EXPECT_THAT(factor.relative_pose(0, 1).T_a_b.to_vector(),
              is_near(Eigen::Vector3d(5.0, 0.0, 0.0), 1e-14));
}

TEST(BetweenOffsetSe3, WithoutOffsetsIsBetween) {
  Random random(2);
  BetweenOffsetSe3 factor = random_factor<BetweenOffsetSe3>(random);
  factor.sensor_a = factor.sensor_b = {};
  const BetweenSe3 plain{factor.T_sensor_a_sensor_b_measured, factor.information};
  const Se3 T_map_a = random.pose3(), T_map_b = random.pose3();
  EXPECT_THAT(factor.error(T_map_a, T_map_b, kG2o, nullptr, nullptr),
              is_near(plain.error(T_map_a, T_map_b, kG2o, nullptr, nullptr), 1e-13));
}

TEST(LandmarkXy, IsSeenInTheSensorFrame) {
  LandmarkXy factor;
  factor.sensor.T_body_sensor = Se2(1.0, 0.0, 0.5 * kPi);
  factor.p_sensor_measured = {2.0, 0.0};  // 2 m to the left of the body's nose
  const Se2 T_map_body(10.0, 0.0, 0.0);
  EXPECT_THAT(factor.error(T_map_body, {11.0, 2.0}, kG2o, nullptr, nullptr),
              is_near(Eigen::Vector2d::Zero(), 1e-14));
  EXPECT_THAT(factor.error(T_map_body, {11.0, 2.5}, kG2o, nullptr, nullptr),
              is_near(Eigen::Vector2d(0.5, 0.0), 1e-14));
}

TEST(BearingXy, IsCounterclockwiseFromTheBodyAxisAndWraps) {
  const BearingXy factor{kPi - 0.1, Scalar1d(1.0)};
  const Se2 T_map_body(1.0, 1.0, 0.5 * kPi);
  const Eigen::Vector2d behind = T_map_body * Eigen::Vector2d(-1.0, -std::tan(0.1));
  EXPECT_NEAR(factor.error(T_map_body, behind, kG2o, nullptr, nullptr)[0], 0.2, 1e-14);
}

TEST(RangeBearingXyz, IsRangeAzimuthElevation) {
  const RangeBearingXyz factor{2.0, 0.5 * kPi, kPi / 6.0, Eigen::Matrix3d::Identity()};
  Eigen::Vector3d p_map;
  EXPECT_TRUE(factor.predict_last(Se3(), p_map));
  EXPECT_THAT(p_map, is_near(Eigen::Vector3d(0.0, std::sqrt(3.0), 1.0), 1e-14));
}

TEST(GnssSe2, MeasuresTheAntenna) {
  const GnssSe2 factor{{1.0, 0.0}, {5.0, 6.0}, Eigen::Matrix2d::Identity()};
  EXPECT_THAT(factor.error(Se2(5.0, 5.0, 0.5 * kPi), kG2o, nullptr),
              is_near(Eigen::Vector2d::Zero(), 1e-14));
}

TEST(YawSe3, IgnoresRollAndSmallPitch) {
  const YawSe3 factor{0.7, Scalar1d(1.0)};
  const So3 R = So3::exp({0.0, 0.0, 0.7}) * So3::exp({0.0, 0.4, 0.0}) * So3::exp({0.9, 0.0, 0.0});
  EXPECT_NEAR(factor.error(Se3(R, {1.0, 2.0, 3.0}), kG2o, nullptr)[0], 0.0, 1e-14);
}

TEST(Gravity, ColumnsAreTiltAboutTheMeasuredDirection) {
  const Gravity factor{{0.0, 0.0, -9.81},
                       Eigen::Matrix2d::Identity()};  // level; need not be normalized
  EXPECT_THAT(factor.error(Se3(), kG2o, nullptr), is_near(Eigen::Vector2d::Zero(), 1e-15));
  // Nose up by 0.01 rad: down is then tilted toward the tail, along -x, as seen from the body. b1 =
  // x.
  const Se3 nose_up(So3::exp({0.0, -0.01, 0.0}), {0.0, 0.0, 0.0});
  EXPECT_THAT(factor.error(nose_up, kG2o, nullptr), is_near(Eigen::Vector2d(-0.01, 0.0), 1e-6));
  // Left side up by 0.01 rad (roll about x): down tilts to the right, along -y. b2 = -y.
  const Se3 left_up(So3::exp({0.01, 0.0, 0.0}), {0.0, 0.0, 0.0});
  EXPECT_THAT(factor.error(left_up, kG2o, nullptr), is_near(Eigen::Vector2d(0.0, 0.01), 1e-6));
}

TEST(Gravity, ErrorGrowsToUpsideDownAndIsIndependentOfYaw) {
  const Gravity factor{{0.0, 0.0, -1.0}, Eigen::Matrix2d::Identity()};
  double before = -1.0;
  for (double tilt = 0.0; tilt < 3.14; tilt += 0.01) {
    const So3 R = So3::exp({0.0, 0.0, 1.3}) * So3::exp({tilt, 0.0, 0.0});
    const double length = factor.error(Se3(R, {}), kG2o, nullptr).norm();
    EXPECT_NEAR(length, 2.0 * std::sin(0.5 * tilt), 1e-12);
    EXPECT_GT(length, before);
    before = length;
  }
}

TEST(Gravity, TangentBasisIsOrthonormal) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d m = random.vector<3>().normalized();
    Eigen::Matrix3d frame;
    frame << gravity_tangent_basis(m), m;
    EXPECT_THAT(frame.transpose() * frame, is_near(Eigen::Matrix3d::Identity(), 1e-14));
  }
}

template <class Value>
constexpr int kTangent = Value::RowsAtCompileTime;
template <>
constexpr int kTangent<Se2> = 3;
template <>
constexpr int kTangent<Se3> = 6;

// Evaluates a factor whose geometry degenerates: everything must stay finite.
template <class F, class... Values>
void expect_finite(const F& factor, const Values&... values) {
  std::tuple<Eigen::Matrix<double, F::kDimension, kTangent<Values>>...> J;
  const auto e =
      std::apply([&](auto&... J_e_x) { return factor.error(values..., kG2o, &J_e_x...); }, J);
  EXPECT_TRUE(e.allFinite()) << F::kName;
  std::apply([&](const auto&... J_e_x) { EXPECT_TRUE((J_e_x.allFinite() && ...)) << F::kName; }, J);
}

TEST(PolarFactors, StayFiniteAtZeroRangeAndAtThePoles) {
  Random random(6);
  for (const double distance : {0.0, 1e-300, 1e-160, 1e-12, 1e-9, 1e-6}) {
    const Se2 T2(0.0, 0.0, 0.4);
    const Eigen::Vector2d p2(distance, 0.5 * distance);
    expect_finite(random_factor<BearingXy>(random), T2, p2);
    expect_finite(random_factor<RangeXy>(random), T2, p2);
    expect_finite(random_factor<RangeBearingXy>(random), T2, p2);
    const Se3 T3(random.rotation3(), {});
    expect_finite(random_factor<RangeXyz>(random), T3, Eigen::Vector3d(distance, 0.0, distance));
    expect_finite(random_factor<RangeBearingXyz>(random), T3,
                  Eigen::Vector3d(distance, 0.0, distance));
    expect_finite(random_factor<RangeBearingXyz>(random), Se3(),
                  Eigen::Vector3d(distance, 0.0, 3.0));
    expect_finite(random_factor<YawSe3>(random),
                  Se3(So3::exp({0.0, 0.5 * kPi + distance, 0.0}), {}));
    const Gravity level{{0.0, 0.0, -1.0}, Eigen::Matrix2d::Identity()};
    expect_finite(level, Se3(So3::exp({kPi - distance, 0.0, 0.0}), {}));
  }
}

TEST(RangeXy, PushesALandmarkOffItsObserver) {
  const RangeXy factor{2.0, Scalar1d(1.0)};
  Jacobian<1, 2> J_e_point;
  factor.error(Se2(), Eigen::Vector2d(0.0, 0.0), kG2o, nullptr, &J_e_point);
  EXPECT_GT(J_e_point.norm(), 0.5);
}

// Through the interface the solver uses: the predicted landmark has no error left.
template <class F>
void expect_prediction_is_exact() {
  Random random(9);
  for (int i = 0; i < 50; ++i) {
    TypedBatch<F> batch;
    Values values;
    const auto pose = append_random_variable(F::Variables::kArray[0], random, values);
    const auto point = append_random_variable(F::Variables::kArray[1], random, values);
    batch.add(random_factor<F>(random), {pose, point}, FactorKind::kOther);
    ASSERT_TRUE(batch.predict_last(0, values));
    EXPECT_LT(batch.evaluate_cost(0, 1, {values}).chi2, 1e-24) << F::kName;
  }
}

TEST(LandmarkFactors, PredictTheLandmarkTheyMeasure) {
  expect_prediction_is_exact<LandmarkXy>();
  expect_prediction_is_exact<LandmarkXyz>();
  expect_prediction_is_exact<RangeBearingXy>();
  expect_prediction_is_exact<RangeBearingXyz>();
}

TEST(LandmarkFactors, DoNotPredictFromABearingOrARangeAlone) {
  Random random(9);
  Values values;
  values.pose2.emplace_back();
  values.point2.emplace_back(1.0, 1.0);
  TypedBatch<BearingXy> bearings;
  bearings.add(random_factor<BearingXy>(random), {0, 0}, FactorKind::kOther);
  EXPECT_FALSE(bearings.predict_last(0, values));
  TypedBatch<RangeXy> ranges;
  ranges.add(random_factor<RangeXy>(random), {0, 0}, FactorKind::kOther);
  EXPECT_FALSE(ranges.predict_last(0, values));
  EXPECT_EQ(values.point2[0], Eigen::Vector2d(1.0, 1.0));
}

TEST(BetweenFactors, TellTheirRelativePoseWithIsotropicWeights) {
  Random random(10);
  const Se3 T_a_b = random.pose3();
  Vector6d diagonal;
  diagonal << 1.0, 2.0, 4.0, 10.0, 20.0, 40.0;
  TypedBatch<BetweenSe3> batch;
  batch.add({T_a_b, diagonal.asDiagonal()}, {4, 7}, FactorKind::kLoop);
  const std::vector<RelativePose<Se3>> poses = batch.relative_poses3();
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].a, 4u);
  EXPECT_EQ(poses[0].b, 7u);
  EXPECT_NEAR(poses[0].translation_weight, 3.0 / 1.75, 1e-14);
  EXPECT_NEAR(poses[0].rotation_weight, 30.0 / 1.75, 1e-13);
  EXPECT_TRUE(batch.relative_poses2().empty());
}

TEST(BetweenSe3, ChartsDifferAsDocumented) {
  Random random(11);
  const Se3 T_map_a = random.pose3();
  const double angle = 0.5;
  const Se3 T_a_b(So3::exp({0.0, 0.0, angle}), {1.0, 2.0, 3.0});
  const BetweenSe3 factor{Se3(), Matrix6d::Identity()};
  const Vector6d g2o = factor.error(T_map_a, T_map_a * T_a_b, ErrorChart::kG2o, nullptr, nullptr);
  EXPECT_THAT(g2o.head<3>(), is_near(T_a_b.translation(), 1e-13));
  EXPECT_THAT(g2o.tail<3>(),
              is_near(Eigen::Vector3d(0.0, 0.0, 2.0 * std::sin(0.5 * angle)), 1e-13));
  const Vector6d log = factor.error(T_map_a, T_map_a * T_a_b, ErrorChart::kLog, nullptr, nullptr);
  EXPECT_THAT(log, is_near(T_a_b.log(), 1e-13));
  EXPECT_EQ(factor.information_in(ErrorChart::kLog)(5, 5), 1.0);
  EXPECT_EQ(factor.information_in(ErrorChart::kGtsam)(5, 5), 4.0);
}

}  // namespace
}  // namespace cairn::test
