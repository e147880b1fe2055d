// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "cairn/io/graph_file.hpp"

namespace cairn::cli {

/// What `cairn info` tells about a graph as it was read.
struct GraphFacts {
  std::map<std::string, std::size_t> variables, factors;  ///< per type
  std::size_t odometry = 0, loops = 0, fixed = 0, without_start = 0;
  std::size_t components = 0, components_without_gauge = 0;
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d highest = -lowest;  ///< m; z is 0 in the plane
  double path_m = 0.0;                ///< along the poses in the order of ids, robot by robot
  long degrees_of_freedom = 0;        ///< rows - variable dimensions + gauge dimensions
  std::optional<double> chi2{};       ///< in g2o's chart; nothing where the file has no vertices
};

GraphFacts collect_facts(const GraphDocument& document);

}  // namespace cairn::cli
