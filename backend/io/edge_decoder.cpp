// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/edge_decoder.hpp"

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

template <int N>
Eigen::Matrix<double, N, N> information(const EdgeFields& f) {
  return read_information<N>(f.tag->layout, f.information);
}
template <int N>
Eigen::Matrix<double, N, 1> vector(const EdgeFields& f, std::size_t first = 0) {
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(f.measurement.data() + first);
}
SensorOffset<Se2> sensor2(const EdgeFields& f, std::size_t k) {
  return {*f.offsets2[k], f.parameters[k]};
}
SensorOffset<Se3> sensor3(const EdgeFields& f, std::size_t k) {
  return {*f.offsets3[k], f.parameters[k]};
}

BetweenSe2 between_se2(const EdgeFields& f) {
  return {se2_from_columns(f.measurement), information<3>(f)};
}
BetweenSe3 between_se3(const EdgeFields& f) {
  return {se3_from_quaternion_columns(f.measurement), information<6>(f)};
}
BetweenSe3 between_se3_angles(const EdgeFields& f) {
  return {se3_from_roll_pitch_yaw_columns(f.measurement), information<6>(f)};
}
BetweenOffsetSe2 between_offset_se2(const EdgeFields& f) {
  return {se2_from_columns(f.measurement), sensor2(f, 0), sensor2(f, 1), information<3>(f)};
}
BetweenOffsetSe3 between_offset_se3(const EdgeFields& f) {
  return {se3_from_quaternion_columns(f.measurement), sensor3(f, 0), sensor3(f, 1),
          information<6>(f)};
}
PriorSe2 prior_se2(const EdgeFields& f) {
  return {se2_from_columns(f.measurement), information<3>(f)};
}
PriorXy prior_xy(const EdgeFields& f) { return {vector<2>(f), information<2>(f)}; }
PriorSe3 prior_se3(const EdgeFields& f) {
  return {se3_from_quaternion_columns(f.measurement), sensor3(f, 0), information<6>(f)};
}
LandmarkXy landmark_xy(const EdgeFields& f) { return {vector<2>(f), {}, information<2>(f)}; }
LandmarkXy landmark_xy_offset(const EdgeFields& f) {
  return {vector<2>(f), sensor2(f, 0), information<2>(f)};
}
LandmarkXyz landmark_xyz(const EdgeFields& f) {
  return {vector<3>(f), sensor3(f, 0), information<3>(f)};
}
BearingXy bearing_xy(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
RangeXy range_xy(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
RangeXyz range_xyz(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
RangeBearingXy range_bearing_xy(const EdgeFields& f) {
  return {f.measurement[0], f.measurement[1], information<2>(f)};
}
RangeBearingXyz range_bearing_xyz(const EdgeFields& f) {
  return {f.measurement[0], f.measurement[1], f.measurement[2], information<3>(f)};
}
GnssSe2 gnss_se2(const EdgeFields& f) { return {vector<2>(f), vector<2>(f, 2), information<2>(f)}; }
GnssSe3 gnss_se3(const EdgeFields& f) { return {vector<3>(f), vector<3>(f, 3), information<3>(f)}; }
Altitude altitude(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
YawSe2 yaw_se2(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
YawSe3 yaw_se3(const EdgeFields& f) { return {f.measurement[0], information<1>(f)}; }
Gravity gravity(const EdgeFields& f) { return {vector<3>(f), information<2>(f)}; }

template <auto kDecode>
constexpr EdgeDecoder decoder() {
  using Factor = decltype(kDecode(std::declval<const EdgeFields&>()));
  return {.add =
              [](Graph& graph, const EdgeFields& fields, FactorKind kind) {
                std::array<VariableId, Factor::Variables::kArity> ids;
                std::copy_n(fields.ids.begin(), ids.size(), ids.begin());
                return graph.add_factor(kDecode(fields), ids, kind);
              },
          .reserve = [](Graph& graph, std::size_t count) { graph.reserve_factors<Factor>(count); }};
}

struct Entry {
  std::string_view tag;
  VariableType first;
  EdgeDecoder decoder;
};
constexpr auto k2 = VariableType::kPose2;
constexpr auto k3 = VariableType::kPose3;
constexpr Entry kEntries[] = {
    {"EDGE_SE2", k2, decoder<between_se2>()},
    {"EDGE_SE3:QUAT", k3, decoder<between_se3>()},
    {"EDGE_SE2_XY", k2, decoder<landmark_xy>()},
    {"EDGE_BEARING_SE2_XY", k2, decoder<bearing_xy>()},
    {"EDGE_SE3_TRACKXYZ", k3, decoder<landmark_xyz>()},
    {"EDGE_SE2_OFFSET", k2, decoder<between_offset_se2>()},
    {"EDGE_SE2_POINTXY_OFFSET", k2, decoder<landmark_xy_offset>()},
    {"EDGE_SE3_OFFSET", k3, decoder<between_offset_se3>()},
    {"EDGE_PRIOR_SE2", k2, decoder<prior_se2>()},
    {"EDGE_PRIOR_SE2_XY", k2, decoder<prior_xy>()},
    {"EDGE_SE3_PRIOR", k3, decoder<prior_se3>()},
    {"EDGE_CAIRN_RANGE", k2, decoder<range_xy>()},
    {"EDGE_CAIRN_RANGE", k3, decoder<range_xyz>()},
    {"EDGE_CAIRN_RANGE_BEARING", k2, decoder<range_bearing_xy>()},
    {"EDGE_CAIRN_RANGE_BEARING", k3, decoder<range_bearing_xyz>()},
    {"EDGE_CAIRN_GNSS", k2, decoder<gnss_se2>()},
    {"EDGE_CAIRN_GNSS", k3, decoder<gnss_se3>()},
    {"EDGE_CAIRN_ALTITUDE", k3, decoder<altitude>()},
    {"EDGE_CAIRN_YAW", k2, decoder<yaw_se2>()},
    {"EDGE_CAIRN_YAW", k3, decoder<yaw_se3>()},
    {"EDGE_CAIRN_GRAVITY", k3, decoder<gravity>()},
    {"EDGE2", k2, decoder<between_se2>()},
    {"EDGE3", k3, decoder<between_se3_angles>()},
    {"ODOMETRY", k2, decoder<between_se2>()},
    {"LANDMARK", k2, decoder<landmark_xy>()},
    {"P", k2, decoder<between_se2>()},
    {"L", k2, decoder<landmark_xy>()},
};

}  // namespace

const EdgeDecoder& edge_decoder(const TagSpec& tag) {
  for (const Entry& entry : kEntries) {
    if (entry.tag == tag.name && entry.first == tag.variables[0]) return entry.decoder;
  }
  CAIRN_CHECK(false, "an edge tag has no decoder");
}

Se2 se2_from_columns(std::span<const double> columns) {
  return {columns[0], columns[1], columns[2]};
}

Se3 se3_from_quaternion_columns(std::span<const double> c) {
  return {So3(Eigen::Quaterniond(c[6], c[3], c[4], c[5])), Eigen::Vector3d(c[0], c[1], c[2])};
}

Se3 se3_from_roll_pitch_yaw_columns(std::span<const double> c) {
  return {rotation_from_roll_pitch_yaw({c[3], c[4], c[5]}), Eigen::Vector3d(c[0], c[1], c[2])};
}

}  // namespace cairn
