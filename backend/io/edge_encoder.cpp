// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/edge_encoder.hpp"

#include <algorithm>

#include "cairn/factors/altitude.hpp"
#include "cairn/factors/bearing.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/factors/between_offset.hpp"
#include "cairn/factors/gnss.hpp"
#include "cairn/factors/gravity.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/factors/prior.hpp"
#include "cairn/factors/range.hpp"
#include "cairn/factors/range_bearing.hpp"
#include "cairn/factors/yaw.hpp"
#include "cairn/io/information_columns.hpp"
#include "cairn/io/roll_pitch_yaw.hpp"

namespace cairn {
namespace {

bool equal(const Se2& a, const Se2& b) { return a.to_vector() == b.to_vector(); }
bool equal(const Se3& a, const Se3& b) {
  return a.translation() == b.translation() &&
         a.rotation().quaternion().coeffs() == b.rotation().quaternion().coeffs();
}

/// Collects the columns of one line.
struct Columns {
  GraphFormat format;
  FactorKind kind;
  OffsetNames& offsets;
  EdgeLine& line;

  Columns& tag(std::string_view name) {
    line.tag = name;
    return *this;
  }
  template <class Pose>
  Columns& sensor(const SensorOffset<Pose>& sensor) {
    line.parameters.push_back(offsets.name(sensor.T_body_sensor, sensor.parameter));
    return *this;
  }
  Columns& number(double x) {
    line.numbers.push_back(x);
    return *this;
  }
  template <int N>
  Columns& vector(const Eigen::Matrix<double, N, 1>& v) {
    line.numbers.insert(line.numbers.end(), v.data(), v.data() + N);
    return *this;
  }
  Columns& pose(const Se2& pose) {
    append_se2(pose, line.numbers);
    return *this;
  }
  Columns& pose(const Se3& pose) {
    append_se3_quaternion(pose, line.numbers);
    return *this;
  }
  template <int N>
  bool information(const Eigen::Matrix<double, N, N>& omega) {
    line.information_error =
        write_information<N>(find_tag(format, line.tag)->layout, omega, line.numbers);
    return true;
  }
  [[nodiscard]] bool is_g2o() const { return format == GraphFormat::kG2o; }
};

bool encode(const BetweenSe2& f, Columns c) {
  const bool odometry = c.format == GraphFormat::kIsam && c.kind == FactorKind::kOdometry;
  c.tag(c.is_g2o() ? "EDGE_SE2" : odometry ? "ODOMETRY" : "EDGE2");
  return c.pose(f.T_a_b_measured).information<3>(f.information);
}

bool encode(const BetweenSe3& f, Columns c) {
  if (c.is_g2o())
    return c.tag("EDGE_SE3:QUAT").pose(f.T_a_b_measured).information<6>(f.information);
  append_se3_roll_pitch_yaw(f.T_a_b_measured, c.line.numbers);
  return c.tag("EDGE3").information<6>(f.information);
}

bool encode(const LandmarkXy& f, Columns c) {
  if (c.format == GraphFormat::kToro) return false;
  const bool at_body = equal(f.sensor.T_body_sensor, Se2());
  if (c.format == GraphFormat::kIsam) {
    return at_body &&
           c.tag("LANDMARK").vector<2>(f.p_sensor_measured).information<2>(f.information);
  }
  if (at_body && !f.sensor.parameter) {
    return c.tag("EDGE_SE2_XY").vector<2>(f.p_sensor_measured).information<2>(f.information);
  }
  c.tag("EDGE_SE2_POINTXY_OFFSET").sensor(f.sensor);
  return c.vector<2>(f.p_sensor_measured).information<2>(f.information);
}

// The others have lines in g2o files only.
bool encode(const LandmarkXyz& f, Columns c) {
  c.tag("EDGE_SE3_TRACKXYZ").sensor(f.sensor);
  return c.vector<3>(f.p_sensor_measured).information<3>(f.information);
}
bool encode(const BetweenOffsetSe2& f, Columns c) {
  c.tag("EDGE_SE2_OFFSET").sensor(f.sensor_a).sensor(f.sensor_b);
  return c.pose(f.T_sensor_a_sensor_b_measured).information<3>(f.information);
}
bool encode(const BetweenOffsetSe3& f, Columns c) {
  c.tag("EDGE_SE3_OFFSET").sensor(f.sensor_a).sensor(f.sensor_b);
  return c.pose(f.T_sensor_a_sensor_b_measured).information<6>(f.information);
}
bool encode(const PriorSe2& f, Columns c) {
  return c.tag("EDGE_PRIOR_SE2").pose(f.T_map_body_measured).information<3>(f.information);
}
bool encode(const PriorXy& f, Columns c) {
  return c.tag("EDGE_PRIOR_SE2_XY").vector<2>(f.p_map_measured).information<2>(f.information);
}
bool encode(const PriorSe3& f, Columns c) {
  return c.tag("EDGE_SE3_PRIOR")
      .sensor(f.sensor)
      .pose(f.T_map_sensor_measured)
      .information<6>(f.information);
}
bool encode(const BearingXy& f, Columns c) {
  return c.tag("EDGE_BEARING_SE2_XY").number(f.bearing_rad_measured).information<1>(f.information);
}
bool encode(const RangeXy& f, Columns c) {
  return c.tag("EDGE_CAIRN_RANGE").number(f.range_m_measured).information<1>(f.information);
}
bool encode(const RangeXyz& f, Columns c) {
  return c.tag("EDGE_CAIRN_RANGE").number(f.range_m_measured).information<1>(f.information);
}
bool encode(const RangeBearingXy& f, Columns c) {
  c.tag("EDGE_CAIRN_RANGE_BEARING").number(f.range_m_measured).number(f.bearing_rad_measured);
  return c.information<2>(f.information);
}
bool encode(const RangeBearingXyz& f, Columns c) {
  c.tag("EDGE_CAIRN_RANGE_BEARING").number(f.range_m_measured);
  c.number(f.azimuth_rad_measured).number(f.elevation_rad_measured);
  return c.information<3>(f.information);
}
bool encode(const GnssSe2& f, Columns c) {
  c.tag("EDGE_CAIRN_GNSS").vector<2>(f.p_body_antenna).vector<2>(f.p_map_antenna_measured);
  return c.information<2>(f.information);
}
bool encode(const GnssSe3& f, Columns c) {
  c.tag("EDGE_CAIRN_GNSS").vector<3>(f.p_body_antenna).vector<3>(f.p_map_antenna_measured);
  return c.information<3>(f.information);
}
bool encode(const Altitude& f, Columns c) {
  return c.tag("EDGE_CAIRN_ALTITUDE").number(f.z_map_m_measured).information<1>(f.information);
}
bool encode(const YawSe2& f, Columns c) {
  return c.tag("EDGE_CAIRN_YAW").number(f.yaw_rad_measured).information<1>(f.information);
}
bool encode(const YawSe3& f, Columns c) {
  return c.tag("EDGE_CAIRN_YAW").number(f.yaw_rad_measured).information<1>(f.information);
}
bool encode(const Gravity& f, Columns c) {
  return c.tag("EDGE_CAIRN_GRAVITY").vector<3>(f.down_body_measured).information<2>(f.information);
}

template <class F>
constexpr bool kBeyondG2o =
    std::is_same_v<F, BetweenSe2> || std::is_same_v<F, BetweenSe3> || std::is_same_v<F, LandmarkXy>;

template <class F>
bool encode_in_batch(const FactorBatch& batch, std::size_t factor, GraphFormat format,
                     OffsetNames& offsets, EdgeLine& line) {
  if (format != GraphFormat::kG2o && !kBeyondG2o<F>) return false;
  line.parameters.clear();
  line.numbers.clear();
  const auto& typed = static_cast<const TypedBatch<F>&>(batch);
  return encode(typed.factor(factor), Columns{format, batch.kinds()[factor], offsets, line});
}

template <class F>
bool holds(const FactorBatch& batch) {
  return dynamic_cast<const TypedBatch<F>*>(&batch) != nullptr;
}

template <class... F>
EncodeFactor encoder_among(const FactorBatch& batch) {
  EncodeFactor encoder = nullptr;
  ((holds<F>(batch) ? void(encoder = encode_in_batch<F>) : void()), ...);
  return encoder;
}

}  // namespace

EncodeFactor edge_encoder(const FactorBatch& batch) {
  return encoder_among<BetweenSe2, BetweenSe3, LandmarkXy, LandmarkXyz, BetweenOffsetSe2,
                       BetweenOffsetSe3, PriorSe2, PriorXy, PriorSe3, BearingXy, RangeXy, RangeXyz,
                       RangeBearingXy, RangeBearingXyz, GnssSe2, GnssSe3, Altitude, YawSe2, YawSe3,
                       Gravity>(batch);
}

void append_se2(const Se2& pose, std::vector<double>& columns) {
  columns.insert(columns.end(), {pose.x(), pose.y(), pose.theta()});
}

void append_se3_quaternion(const Se3& pose, std::vector<double>& columns) {
  Eigen::Vector4d q = pose.rotation().quaternion().coeffs();
  if (q.w() < 0.0) q = Eigen::Vector4d::Zero() - q;  // not -q: no negative zeros
  const Eigen::Vector3d& t = pose.translation();
  columns.insert(columns.end(), {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

void append_se3_roll_pitch_yaw(const Se3& pose, std::vector<double>& columns) {
  const Eigen::Vector3d& t = pose.translation();
  const auto angles = roll_pitch_yaw_from_rotation(pose.rotation());
  columns.insert(columns.end(), {t.x(), t.y(), t.z(), angles[0], angles[1], angles[2]});
}

template <class Pose>
ParameterId OffsetNames::name_in(std::map<ParameterId, Pose>& offsets, const Pose& offset,
                                 const std::optional<ParameterId>& wish) {
  if (wish && wish->value >= 0 && equal(offsets.emplace(*wish, offset).first->second, offset))
    return *wish;
  const auto same = std::find_if(offsets.begin(), offsets.end(),
                                 [&](const auto& known) { return equal(known.second, offset); });
  if (same != offsets.end()) return same->first;
  ParameterId fresh{0};  // one number space for both kinds: g2o does not tell them apart
  while (offsets2_.count(fresh) || offsets3_.count(fresh)) ++fresh.value;
  offsets.emplace(fresh, offset);
  return fresh;
}

ParameterId OffsetNames::name(const Se2& T_body_sensor, const std::optional<ParameterId>& wish) {
  return name_in(offsets2_, T_body_sensor, wish);
}
ParameterId OffsetNames::name(const Se3& T_body_sensor, const std::optional<ParameterId>& wish) {
  return name_in(offsets3_, T_body_sensor, wish);
}

}  // namespace cairn
