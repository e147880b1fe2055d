// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "cairn/graph/variable.hpp"
#include "cairn/io/graph_file.hpp"

namespace cairn {

enum class TagRole : std::uint8_t {
  kVertex,       ///< id, value
  kEdge,         ///< variable ids, parameter ids, measurement, information
  kParameter,    ///< parameter id, value
  kFix,          ///< one or more variable ids
  kEquivalence,  ///< two variable ids of one pose
};

/// How the information columns of an edge are to be read (backend/io/README.md).
enum class InformationLayout : std::uint8_t {
  kUpperTriangle,  ///< row-major upper triangle of Omega
  kG2oSe3,  ///< as above, the rotation for the imaginary part of the quaternion: not in radians
  kToro2,   ///< ff fs ss rr fr sr
  kSquareRootFactor,  ///< row-major upper triangle of R with Omega = R^T R
  kFullMatrix,        ///< all of Omega, row-major
};

/// One kind of line. Columns behind the tag: variable ids, parameter ids, measurement (or value),
/// information.
struct TagSpec {
  std::string_view name;
  TagRole role = TagRole::kEdge;
  int variable_count = 0;
  std::array<VariableType, 2> variables{};  ///< the first variable_count
  int parameter_count = 0;
  int measurement = 0;  ///< columns
  unsigned angles = 0;  ///< bit i: measurement column i is an angle in radians
  int quaternion = -1;  ///< measurement column where a quaternion x y z w begins, or -1
  int information = 0;  ///< dimension N of the information: N (N + 1) / 2 columns
  InformationLayout layout = InformationLayout::kUpperTriangle;
  bool information_optional = false;  ///< a line without these columns means the identity
  std::string_view what = {};         ///< for people: "relative pose in the plane (x y theta)"

  [[nodiscard]] int id_columns() const { return variable_count + parameter_count; }
  [[nodiscard]] int information_columns() const {
    return layout == InformationLayout::kFullMatrix ? information * information
                                                    : information * (information + 1) / 2;
  }
  /// All columns behind the tag. FIX takes any number of ids from one on.
  [[nodiscard]] int columns() const { return id_columns() + measurement + information_columns(); }
};

/// The tags of a format; for kDlr those of the lines of dlr_edges.txt. Some tags of ours have two
/// entries, for poses in the plane and in space.
std::span<const TagSpec> graph_tags(GraphFormat format);

/// The (first) entry of a tag, or null when the format does not know it.
const TagSpec* find_tag(GraphFormat format, std::string_view name);

/// The entry of the same tag whose first variable is of this type, or `tag` where there is none.
const TagSpec& variant_for(GraphFormat format, const TagSpec& tag, VariableType first);

std::string_view to_string(GraphFormat format);

/// The format a text is in, by its tags: g2o by any g2o tag, TORO by VERTEX2 or VERTEX3, iSAM by
/// ODOMETRY or LANDMARK, whichever comes first. An error where the tags do not tell (EDGE2 and
/// EDGE3 alone), or where no tag of any format occurs.
Result<GraphFormat> recognize_graph_format(std::string_view text, std::string_view name);

}  // namespace cairn
