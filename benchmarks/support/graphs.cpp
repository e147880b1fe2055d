// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/graphs.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn::bench {

std::span<const BenchmarkGraph> benchmark_graphs() {
  static constexpr BenchmarkGraph kGraphs[] = {
      {"manhattan", "graphs/pose2/manhattan.g2o", true, false},
      {"intel", "graphs/pose2/intel.g2o", true, false},
      {"CSAIL", "graphs/pose2/CSAIL.g2o", true, false},
      {"city10000", "graphs/pose2/city10000.g2o", true, false},
      {"kitti_00", "graphs/pose2/kitti_00.g2o", true, false},
      {"M3500a", "graphs/pose2/M3500a.g2o", true, true},
      {"sphere2500", "graphs/pose3/sphere2500.g2o", false, false},
      {"parking-garage", "graphs/pose3/parking-garage.g2o", false, false},
      {"sphere_bignoise", "graphs/pose3/sphere_bignoise_vertex3.g2o", false, true},
      {"truth/sphere", "graphs/truth/sphere.g2o", false, true},
  };
  return kGraphs;
}

std::string data_folder() {
  const char* root = std::getenv("CAIRN_DATASETS");
  return root ? root : CAIRN_SOURCE_DIR "/../shared/datasets";
}

std::optional<Graph> load(const BenchmarkGraph& graph) {
  auto document = read_graph(data_folder() + "/" + std::string(graph.path));
  if (!document) {
    std::fprintf(stderr, "%.*s is left out: %s\n", static_cast<int>(graph.name.size()),
                 graph.name.data(), document.error().to_string().c_str());
    return std::nullopt;
  }
  return std::move(document->graph);
}

Graph common_start(const BenchmarkGraph& which, const Graph& loaded) {
  Graph start = loaded;
  if (which.chordal_start) optimize(start, {.init = InitMethod::kChordal, .max_iterations = 0});
  return start;
}

bool Arguments::wants(std::string_view name) const {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--rounds" && i + 1 < argc) {
      arguments.rounds = std::max(1, std::atoi(argv[++i]));
    } else if (argument.starts_with("-")) {
      std::fprintf(stderr, "usage: %s [--rounds N] [GRAPH...]\n", argv[0]);
      std::exit(2);
    } else {
      arguments.names.push_back(argument);
    }
  }
  return arguments;
}

}  // namespace cairn::bench
