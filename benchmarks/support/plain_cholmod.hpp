// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "cairn/linear/linear_solver.hpp"

namespace cairn::bench {

/// The yardstick: CHOLMOD as anybody would call it, with an analysis of its own. It is given our
/// order and knows nothing else of our matrix. make_cholmod_solver() saves it part of the work.
std::unique_ptr<LinearSolver> make_plain_cholmod();

}  // namespace cairn::bench
