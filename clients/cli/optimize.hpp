// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cairn/drawing/picture.hpp"
#include "cairn/solver/solve_options.hpp"
#include "clients/cli/graph_format.hpp"

namespace cairn::cli {

/// What the command line of `cairn optimize` says. Empty paths were not given.
struct OptimizeArguments {
  std::vector<std::string> inputs;
  std::string output;
  FormatChoice format, to;
  SolveOptions solve{.init = InitMethod::kAuto,
                     .threads = 0};  ///< threads 0: as many as there are processors
  std::string loss = "none";
  std::string json, covariances, truth;
  std::vector<std::string> plots;
  bool gate = false, strict = false, quiet = false;
};

/// Reads, solves, and writes what was asked for. Gives the exit code.
int run_optimize(const OptimizeArguments& arguments);

}  // namespace cairn::cli
