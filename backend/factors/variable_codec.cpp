// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/factor_codec.hpp"
#include "cairn/factors/number_row.hpp"

namespace cairn {

std::vector<double> describe_value(const Graph& graph, VariableSlot slot) {
  const Variable& variable = graph.variables()[slot];
  const Values& values = graph.values();
  std::vector<double> numbers;
  numbers.reserve(value_numbers(variable.type));
  NumberWriter write{numbers};
  switch (variable.type) {
    case VariableType::kPose2:
      write(values.pose2[variable.index]);
      break;
    case VariableType::kPose3:
      write(values.pose3[variable.index]);
      break;
    case VariableType::kPoint2:
      write(values.point2[variable.index]);
      break;
    case VariableType::kPoint3:
      write(values.point3[variable.index]);
      break;
  }
  return numbers;
}

std::optional<FactorFault> find_fault(VariableType type, std::span<const double> value) {
  if (value.size() != value_numbers(type)) {
    return FactorFault{RefusalCode::kMalformed,
                       count_fault(to_string(type), value_numbers(type), "numbers", value.size())};
  }
  if (!all_finite(value)) return not_finite(to_string(type));
  if (type == VariableType::kPose3) {
    Se3 T;
    NumberReader reader{value.data()};
    reader(T);
    if (!reader.unit_quaternions) return FactorFault{RefusalCode::kMalformed, kNotUnit};
  }
  return std::nullopt;
}

Result<VariableSlot> add_variable(Graph& graph, VariableId id, VariableType type,
                                  std::span<const double> start) {
  NumberReader read{start.data()};
  switch (type) {
    case VariableType::kPose2: {
      Se2 T;
      read(T);
      return graph.add_pose2(id, T);
    }
    case VariableType::kPose3: {
      Se3 T;
      read(T);
      return graph.add_pose3(id, T);
    }
    case VariableType::kPoint2:
      return graph.add_point2(id, Eigen::Vector2d(start[0], start[1]));
    case VariableType::kPoint3:
      break;
  }
  return graph.add_point3(id, Eigen::Vector3d(start[0], start[1], start[2]));
}

}  // namespace cairn
