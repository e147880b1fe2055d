// SPDX-License-Identifier: BSD-3-Clause
// Reads a graph file, optimizes it, writes the result: the example of the README.
#include <cairn/core/exit_code.hpp>
#include <cairn/io/graph_file.hpp>
#include <cairn/solver/optimize.hpp>
#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) return cairn::fail({cairn::ErrorCode::kUsage, "usage: optimize_file IN OUT"});
  auto file = cairn::read_graph(argv[1]);       // format recognized by content
  if (!file) return cairn::fail(file.error());  // intel.g2o:312:9: what was expected
  const cairn::SolveSummary summary =
      cairn::optimize(file->graph, {.init = cairn::InitMethod::kAuto});
  std::cout << summary << '\n';  // why it stopped, chi2 before -> after
  if (!summary.usable()) return 4;
  return cairn::exit_code(cairn::write_graph(*file, argv[2], file->format));
}
