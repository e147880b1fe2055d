// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn {

/// What the true motion between two moments was: the pose of the sensor at `to_ns`, seen from where
/// it was at `from_ns`.
struct Relation {
  std::uint64_t from_ns, to_ns;
  Se3 T_from_to;
  std::size_t line;  ///< in the file
};

/// In order of the file, never empty.
struct Relations {
  std::string name;  ///< of the file, for messages
  std::vector<Relation> relations{};
};

/// Reads relations, text, .gz or .bz2, told apart by content. Either lines `t1 t2 x y z roll pitch
/// yaw` (s, m, rad), or a log with its graph in it: each VERTEX2 with the ROBOTLASER1 behind it
/// that gives its stamp, and as relations the EDGE2 between scans that do not follow each other,
/// its loops. Errors name file:line:column.
Result<Relations> read_relations(const std::string& path);

/// The same from memory; `name` stands for the file in messages.
Result<Relations> read_relations_text(std::string_view text, const std::string& name);

}  // namespace cairn
