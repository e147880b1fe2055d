// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "cairn/io/number_line.hpp"
#include "cairn/io/trajectory.hpp"

namespace cairn {
namespace {

constexpr std::size_t kTumFields = 8, kKittiFields = 12;
// Files round to 4 digits and more; what is further off is no rotation.
constexpr double kRotationTolerance = 0.01;

Result<TrajectoryPose> read_tum(const Record& record, std::string_view file) {
  const auto fields =
      split<kTumFields>(record, file, "a TUM line has 8 numbers (stamp tx ty tz qx qy qz qw)");
  if (!fields) return fields.error();
  const Result<std::uint64_t> stamp = stamp_in((*fields)[0], record, file);
  if (!stamp) return stamp.error();
  std::array<double, kTumFields> v;
  for (std::size_t i = 1; i < kTumFields; ++i) {
    const Result<double> number = number_in((*fields)[i], record, file);
    if (!number) return number.error();
    v[i] = *number;
  }
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (!(std::abs(q.norm() - 1.0) <= kRotationTolerance)) {
    return error_at(record, file, (*fields)[4].column,
                    "the quaternion has norm " + std::to_string(q.norm()) +
                        "; a unit quaternion qx qy qz qw is expected");
  }
  return TrajectoryPose{*stamp, {So3(q), {v[1], v[2], v[3]}}};
}

Result<TrajectoryPose> read_kitti(const Record& record, std::string_view file,
                                  std::uint64_t index) {
  const auto fields = split<kKittiFields>(
      record, file, "a KITTI line has 12 numbers (the upper 3 x 4 of the pose, row by row)");
  if (!fields) return fields.error();
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> T;
  for (std::size_t i = 0; i < kKittiFields; ++i) {
    const Result<double> number = number_in((*fields)[i], record, file);
    if (!number) return number.error();
    T.data()[i] = *number;
  }
  const Eigen::Matrix3d R = T.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kRotationTolerance) || R.determinant() < 0.0) {
    return error_at(
        record, file, (*fields)[0].column,
        "columns 1-3, 5-7 and 9-11 are not a rotation matrix (orthonormal, determinant 1)");
  }
  return TrajectoryPose{index, {So3::project(R), T.col(3)}};
}

}  // namespace

std::optional<TrajectoryFormat> recognize_trajectory(std::string_view text) {
  RecordScanner scanner(text);
  Record record;
  if (!scanner.next(record)) return TrajectoryFormat::kTum;
  double number;
  const NumberFault fault = parse_number(record.tag, number);
  if (fault == NumberFault::kNotANumber) return std::nullopt;
  const std::size_t fields = count_fields(record) + 1;
  if (fields == kKittiFields) return TrajectoryFormat::kKitti;
  return fields == kTumFields ? std::optional(TrajectoryFormat::kTum) : std::nullopt;
}

Result<Trajectory> read_trajectory_text(std::string_view text, const std::string& name) {
  RecordScanner scanner(text);
  Record record;
  Trajectory trajectory{.name = name};
  while (scanner.next(record)) {
    if (trajectory.poses.empty()) {
      const auto format = recognize_trajectory(record.line);
      if (!format) {
        return error_at(record, name, 1,
                        "not a trajectory: the first line has " +
                            std::to_string(count_fields(record) + 1) +
                            " fields; 8 numbers (TUM) or 12 numbers (KITTI) are expected");
      }
      trajectory.format = *format;
    }
    auto pose = trajectory.format == TrajectoryFormat::kTum
                    ? read_tum(record, name)
                    : read_kitti(record, name, trajectory.poses.size());
    if (!pose) return pose.error();
    trajectory.poses.push_back(*pose);
  }
  if (trajectory.poses.empty())
    return Error{ErrorCode::kBadInput, "holds no poses", place_in(name, 1, 1)};
  return trajectory;
}

}  // namespace cairn
