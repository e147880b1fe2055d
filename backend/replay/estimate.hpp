// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "cairn/graph/pose_graph.hpp"

namespace cairn {

Estimate to_estimate(std::span<const double> numbers);

/// The pose at the other end of a measured relative pose: behind it (`forward`) or before it.
/// Nothing where the factor measures no relative pose.
std::optional<Estimate> compose(const Estimate& known, const NewFactor& factor, bool forward);

}  // namespace cairn
