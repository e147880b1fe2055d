// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/diagnostics/structure_checks.hpp"

namespace cairn {

/// The tag of vertex lines of a type; null where the format has none.
const TagSpec* vertex_tag(GraphFormat format, VariableType type);

/// The text as the reader can take it: unusable lines are blank; broken ones carry neutral numbers,
/// so that what they connect stays connected; vertices without a line (`dangling`) get neutral ones
/// at the end. Lines keep their numbers.
std::string sound_text(const RawGraph& graph, const RawStructure& structure);

}  // namespace cairn
