// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn::bench {

/// A public graph and where both sides start.
struct BenchmarkGraph {
  std::string_view name;
  std::string_view path;  ///< below the data set folder
  bool planar;
  bool chordal_start;  ///< the file's start leads elsewhere: both sides start from one chordal
                       ///< estimate
};

/// The graphs of the comparison with Ceres.
std::span<const BenchmarkGraph> benchmark_graphs();

/// $CAIRN_DATASETS, by default ../shared/datasets beside the source tree.
std::string data_folder();

/// Reads a graph below it. Says on standard error why there is none. Values: the file's, or
/// odometry where it has edges only.
std::optional<Graph> load(const BenchmarkGraph& graph);

/// The graph where both sides start.
Graph common_start(const BenchmarkGraph& which, const Graph& loaded);

/// Command line of a benchmark: `--rounds N` (default 9) and names of graphs (default all).
struct Arguments {
  int rounds = 9;
  std::vector<std::string> names;

  [[nodiscard]] bool wants(std::string_view name) const;
};
Arguments parse_arguments(int argc, char** argv);

}  // namespace cairn::bench
