// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/graph_tags.hpp"

#include "cairn/io/record_scanner.hpp"

namespace cairn {
namespace {

constexpr auto kPose2 = VariableType::kPose2;
constexpr auto kPose3 = VariableType::kPose3;
constexpr auto kPoint2 = VariableType::kPoint2;
constexpr auto kPoint3 = VariableType::kPoint3;

constexpr TagSpec vertex(std::string_view name, VariableType type, int columns, unsigned angles,
                         int quaternion, std::string_view what) {
  return {.name = name,
          .role = TagRole::kVertex,
          .variable_count = 1,
          .variables = {type, type},
          .measurement = columns,
          .angles = angles,
          .quaternion = quaternion,
          .what = what};
}

// Two kinds of line every text format takes.
constexpr TagSpec kFix{.name = "FIX", .role = TagRole::kFix, .what = "hold these vertices"};
constexpr TagSpec kEquiv{.name = "EQUIV",
                         .role = TagRole::kEquivalence,
                         .variable_count = 2,
                         .variables = {kPose2, kPose2},
                         .what = "two ids of one pose"};

constexpr TagSpec kG2oTags[] = {
    vertex("VERTEX_SE2", kPose2, 3, 0b100, -1, "pose in the plane (x y theta)"),
    {.name = "EDGE_SE2",
     .variable_count = 2,
     .variables = {kPose2, kPose2},
     .measurement = 3,
     .angles = 0b100,
     .information = 3,
     .what = "relative pose in the plane (x y theta)"},
    vertex("VERTEX_SE3:QUAT", kPose3, 7, 0, 3, "pose in space (x y z qx qy qz qw)"),
    {.name = "EDGE_SE3:QUAT",
     .variable_count = 2,
     .variables = {kPose3, kPose3},
     .measurement = 7,
     .quaternion = 3,
     .information = 6,
     .layout = InformationLayout::kG2oSe3,
     .what = "relative pose in space (x y z qx qy qz qw)"},
    vertex("VERTEX_XY", kPoint2, 2, 0, -1, "landmark in the plane (x y)"),
    vertex("VERTEX_TRACKXYZ", kPoint3, 3, 0, -1, "landmark in space (x y z)"),
    {.name = "EDGE_SE2_XY",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 2,
     .information = 2,
     .what = "landmark seen from a pose (x y)"},
    {.name = "EDGE_BEARING_SE2_XY",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 1,
     .angles = 0b1,
     .information = 1,
     .what = "direction to a landmark (bearing)"},
    {.name = "EDGE_SE3_TRACKXYZ",
     .variable_count = 2,
     .variables = {kPose3, kPoint3},
     .parameter_count = 1,
     .measurement = 3,
     .information = 3,
     .what = "landmark seen from a sensor (x y z)"},
    {.name = "EDGE_SE2_OFFSET",
     .variable_count = 2,
     .variables = {kPose2, kPose2},
     .parameter_count = 2,
     .measurement = 3,
     .angles = 0b100,
     .information = 3,
     .what = "relative pose between sensors in the plane (x y theta)"},
    {.name = "EDGE_SE2_POINTXY_OFFSET",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .parameter_count = 1,
     .measurement = 2,
     .information = 2,
     .what = "landmark seen from a sensor in the plane (x y)"},
    {.name = "EDGE_SE3_OFFSET",
     .variable_count = 2,
     .variables = {kPose3, kPose3},
     .parameter_count = 2,
     .measurement = 7,
     .quaternion = 3,
     .information = 6,
     .layout = InformationLayout::kG2oSe3,
     .what = "relative pose between sensors in space (x y z qx qy qz qw)"},
    {.name = "EDGE_PRIOR_SE2",
     .variable_count = 1,
     .variables = {kPose2},
     .measurement = 3,
     .angles = 0b100,
     .information = 3,
     .what = "pose in the map, in the plane (x y theta)"},
    {.name = "EDGE_PRIOR_SE2_XY",
     .variable_count = 1,
     .variables = {kPose2},
     .measurement = 2,
     .information = 2,
     .what = "position in the map, in the plane (x y)"},
    {.name = "EDGE_SE3_PRIOR",
     .variable_count = 1,
     .variables = {kPose3},
     .parameter_count = 1,
     .measurement = 7,
     .quaternion = 3,
     .information = 6,
     .layout = InformationLayout::kG2oSe3,
     .what = "pose of a sensor in the map (x y z qx qy qz qw)"},
    {.name = "PARAMS_SE2OFFSET",
     .role = TagRole::kParameter,
     .parameter_count = 1,
     .measurement = 3,
     .angles = 0b100,
     .what = "pose of a sensor on the body, in the plane (x y theta)"},
    {.name = "PARAMS_SE3OFFSET",
     .role = TagRole::kParameter,
     .parameter_count = 1,
     .measurement = 7,
     .quaternion = 3,
     .what = "pose of a sensor on the body (x y z qx qy qz qw)"},
    // Ours, for factors without a g2o tag. Twins differ in the space of their pose.
    {.name = "EDGE_CAIRN_RANGE",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 1,
     .information = 1,
     .what = "distance of a landmark in the plane (range)"},
    {.name = "EDGE_CAIRN_RANGE",
     .variable_count = 2,
     .variables = {kPose3, kPoint3},
     .measurement = 1,
     .information = 1,
     .what = "distance of a landmark in space (range)"},
    {.name = "EDGE_CAIRN_RANGE_BEARING",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 2,
     .angles = 0b10,
     .information = 2,
     .what = "distance and direction of a landmark in the plane (range bearing)"},
    {.name = "EDGE_CAIRN_RANGE_BEARING",
     .variable_count = 2,
     .variables = {kPose3, kPoint3},
     .measurement = 3,
     .angles = 0b110,
     .information = 3,
     .what = "distance and direction of a landmark in space (range azimuth elevation)"},
    {.name = "EDGE_CAIRN_GNSS",
     .variable_count = 1,
     .variables = {kPose2},
     .measurement = 4,
     .information = 2,
     .what = "position of an antenna in the map, in the plane (lever arm x y, position x y)"},
    {.name = "EDGE_CAIRN_GNSS",
     .variable_count = 1,
     .variables = {kPose3},
     .measurement = 6,
     .information = 3,
     .what = "position of an antenna in the map (lever arm x y z, position x y z)"},
    {.name = "EDGE_CAIRN_ALTITUDE",
     .variable_count = 1,
     .variables = {kPose3},
     .measurement = 1,
     .information = 1,
     .what = "height of a pose in the map (z)"},
    {.name = "EDGE_CAIRN_YAW",
     .variable_count = 1,
     .variables = {kPose2},
     .measurement = 1,
     .angles = 0b1,
     .information = 1,
     .what = "heading in the map, in the plane (yaw)"},
    {.name = "EDGE_CAIRN_YAW",
     .variable_count = 1,
     .variables = {kPose3},
     .measurement = 1,
     .angles = 0b1,
     .information = 1,
     .what = "heading in the map, in space (yaw)"},
    {.name = "EDGE_CAIRN_GRAVITY",
     .variable_count = 1,
     .variables = {kPose3},
     .measurement = 3,
     .information = 2,
     .what = "direction of gravity in the body (down x y z)"},
    kEquiv,
    kFix,
};

constexpr TagSpec toro_edge3(std::string_view name, InformationLayout layout) {
  return {.name = name,
          .variable_count = 2,
          .variables = {kPose3, kPose3},
          .measurement = 6,
          .angles = 0b111000,
          .information = 6,
          .layout = layout,
          .information_optional = true,
          .what = "relative pose in space (x y z roll pitch yaw)"};
}

constexpr TagSpec isam_edge2(std::string_view name) {
  return {.name = name,
          .variable_count = 2,
          .variables = {kPose2, kPose2},
          .measurement = 3,
          .angles = 0b100,
          .information = 3,
          .layout = InformationLayout::kSquareRootFactor,
          .information_optional = true,
          .what = "relative pose in the plane (x y theta)"};
}

constexpr TagSpec kToroTags[] = {
    vertex("VERTEX2", kPose2, 3, 0b100, -1, "pose in the plane (x y theta)"),
    {.name = "EDGE2",
     .variable_count = 2,
     .variables = {kPose2, kPose2},
     .measurement = 3,
     .angles = 0b100,
     .information = 3,
     .layout = InformationLayout::kToro2,
     .information_optional = true,
     .what = "relative pose in the plane (x y theta)"},
    vertex("VERTEX3", kPose3, 6, 0b111000, -1, "pose in space (x y z roll pitch yaw)"),
    toro_edge3("EDGE3", InformationLayout::kUpperTriangle),
    kEquiv,
    kFix,
};

constexpr TagSpec kIsamTags[] = {
    isam_edge2("ODOMETRY"),
    isam_edge2("EDGE2"),
    toro_edge3("EDGE3", InformationLayout::kSquareRootFactor),
    {.name = "LANDMARK",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 2,
     .information = 2,
     .layout = InformationLayout::kSquareRootFactor,
     .what = "landmark seen from a pose (x y)"},
    kEquiv,
    kFix,
};

constexpr TagSpec kDlrTags[] = {
    {.name = "P",
     .variable_count = 2,
     .variables = {kPose2, kPose2},
     .measurement = 3,
     .angles = 0b100,
     .information = 3,
     .layout = InformationLayout::kFullMatrix,
     .what = "relative pose in the plane (x y theta)"},
    {.name = "L",
     .variable_count = 2,
     .variables = {kPose2, kPoint2},
     .measurement = 2,
     .information = 2,
     .layout = InformationLayout::kFullMatrix,
     .what = "landmark seen from a pose (x y)"},
};

// Tags that tell the format; FIX, EQUIV, EDGE2 and EDGE3 do not.
std::optional<GraphFormat> format_of(std::string_view tag) {
  if (tag == kFix.name || tag == kEquiv.name) return std::nullopt;
  if (find_tag(GraphFormat::kG2o, tag)) return GraphFormat::kG2o;
  if (tag == "VERTEX2" || tag == "VERTEX3") return GraphFormat::kToro;
  if (tag == "ODOMETRY" || tag == "LANDMARK") return GraphFormat::kIsam;
  return std::nullopt;
}

}  // namespace

std::span<const TagSpec> graph_tags(GraphFormat format) {
  switch (format) {
    case GraphFormat::kG2o:
      return kG2oTags;
    case GraphFormat::kToro:
      return kToroTags;
    case GraphFormat::kIsam:
      return kIsamTags;
    case GraphFormat::kDlr:
      return kDlrTags;
  }
  return {};
}

const TagSpec* find_tag(GraphFormat format, std::string_view name) {
  for (const TagSpec& tag : graph_tags(format)) {
    if (tag.name == name) return &tag;
  }
  return nullptr;
}

const TagSpec& variant_for(GraphFormat format, const TagSpec& tag, VariableType first) {
  for (const TagSpec& other : graph_tags(format)) {
    if (other.name == tag.name && other.variables[0] == first) return other;
  }
  return tag;
}

std::string_view to_string(GraphFormat format) {
  constexpr std::string_view kNames[] = {"g2o", "toro", "isam", "dlr"};
  return kNames[static_cast<int>(format)];
}

Result<GraphFormat> recognize_graph_format(std::string_view text, std::string_view name) {
  RecordScanner scanner(text);
  Record record, first;
  bool any = false, ambiguous = false;
  while (scanner.next(record)) {
    if (const auto format = format_of(record.tag)) return *format;
    if (!any) first = record;
    any = true;
    ambiguous |= record.tag == "EDGE2" || record.tag == "EDGE3";
  }
  const std::string where = place_in(name, any ? first.line_number : 1, 1);
  if (!any) return Error{ErrorCode::kBadInput, "the file is empty", where};
  if (ambiguous) {
    return Error{ErrorCode::kBadInput,
                 "EDGE2 and EDGE3 alone do not tell TORO from iSAM; name the format (--format toro "
                 "or --format isam)",
                 where};
  }
  return Error{ErrorCode::kBadInput,
               "not a graph file: no line begins with a known tag, this one begins with '" +
                   quote(first.tag) + "'",
               where};
}

}  // namespace cairn
