// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "cairn/io/graph_file.hpp"

namespace cairn {

/// One edge line to be written, behind its variable ids.
struct EdgeLine {
  std::string_view tag;
  std::vector<ParameterId> parameters;
  std::vector<double> numbers;     ///< measurement, information
  double information_error = 0.0;  ///< of what the columns read as (information_columns.hpp)
};

/// The sensor offsets a file will define. A factor's offset keeps its name where that names the
/// same offset already or nothing yet; otherwise it gets that of an equal offset, or a new one.
class OffsetNames {
 public:
  explicit OffsetNames(const GraphDocument& document)
      : offsets2_(document.offsets2), offsets3_(document.offsets3) {}

  ParameterId name(const Se2& T_body_sensor, const std::optional<ParameterId>& wish);
  ParameterId name(const Se3& T_body_sensor, const std::optional<ParameterId>& wish);
  [[nodiscard]] const std::map<ParameterId, Se2>& offsets2() const { return offsets2_; }
  [[nodiscard]] const std::map<ParameterId, Se3>& offsets3() const { return offsets3_; }

 private:
  template <class Pose>
  ParameterId name_in(std::map<ParameterId, Pose>& offsets, const Pose& offset,
                      const std::optional<ParameterId>& wish);

  std::map<ParameterId, Se2> offsets2_;
  std::map<ParameterId, Se3> offsets3_;
};

/// Fills the line of one factor. False where the format has no line for it.
using EncodeFactor = bool (*)(const FactorBatch& batch, std::size_t factor, GraphFormat format,
                              OffsetNames& offsets, EdgeLine& line);

/// The encoder for a batch, or null for a type that files do not know.
EncodeFactor edge_encoder(const FactorBatch& batch);

/// Appends the columns of a pose: x y theta; x y z qx qy qz qw with qw >= 0; x y z roll pitch yaw.
void append_se2(const Se2& pose, std::vector<double>& columns);
void append_se3_quaternion(const Se3& pose, std::vector<double>& columns);
void append_se3_roll_pitch_yaw(const Se3& pose, std::vector<double>& columns);

}  // namespace cairn
