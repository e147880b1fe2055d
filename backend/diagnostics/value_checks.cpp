// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/value_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cairn/diagnostics/conventions.hpp"
#include "cairn/diagnostics/information_checks.hpp"
#include "cairn/diagnostics/line_repairs.hpp"

namespace cairn {
namespace {

Eigen::Vector4d quaternion_of(const RawGraph& graph, const RawLine& line) {
  const auto numbers =
      graph.measurement(line).subspan(static_cast<std::size_t>(line.tag->quaternion), 4);
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

void check_quaternion(const RawGraph& graph, RawLine& line, Findings& findings, Repairs& repairs) {
  constexpr double kRounding =
      1e-3;  // files with four digits stay below; the readers normalize anyway
  const Eigen::Vector4d q = quaternion_of(graph, line);
  const double norm = q.stableNorm();
  const auto first = static_cast<std::size_t>(line.tag->quaternion);
  if (!(norm > 1e-6) || !std::isfinite(norm)) {
    line.mark_broken(CheckCode::kQuaternionZero);
    findings.add(CheckCode::kQuaternionZero, line.line, number_field(line, first).column,
                 "quaternion of " + describe(line) + " has length " + readable(norm) +
                     ", which is no rotation",
                 "no rotation is 0 0 0 1");
    return;
  }
  if (std::abs(norm - 1.0) <= kRounding) return;
  findings.add(CheckCode::kQuaternionNotUnit, line.line, number_field(line, first).column,
               "quaternion of " + describe(line) + " has length " + readable(norm) + ", expected 1",
               "it is read as if divided by its length; --fix writes it so");
  std::vector<Repairs::Replacement> parts;
  for (std::size_t k = 0; k < 4; ++k) {
    parts.push_back(
        {number_field(line, first + k).text, shortest(q[static_cast<Eigen::Index>(k)] / norm)});
  }
  repairs.replace(CheckCode::kQuaternionNotUnit, line.line, parts,
                  "normalized the quaternion (its length was " + readable(norm) + ")");
}

void check_quaternion_order(const RawGraph& graph, Findings& findings) {
  std::vector<Eigen::Vector4d> quaternions;
  const RawLine* first = nullptr;
  for (const RawLine& line : graph.lines) {
    if (line.broken || !graph.is_edge(line) || line.tag->quaternion < 0) continue;
    if (!first) first = &line;
    quaternions.push_back(quaternion_of(graph, line));
  }
  if (!first || !quaternions_look_w_first(quaternions)) return;
  findings.add(CheckCode::kQuaternionOrder, first->line,
               number_field(*first, static_cast<std::size_t>(first->tag->quaternion)).column,
               "most edges turn by nearly half a turn when read as qx qy qz qw, and hardly when "
               "read as qw qx qy qz",
               "write qw last");
}

// The planar pose edges of a file, with what is known of the poses they connect.
struct PlanarEdges {
  std::vector<std::optional<RawPose2>> poses;
  std::vector<RawEdge2> edges;
  std::vector<std::size_t> lines;  ///< of the edges, into RawGraph::lines
};

bool is_planar_edge(const RawGraph& graph, const RawLine& line) {
  return !line.broken && graph.is_edge(line) && line.tag->variable_count == 2 &&
         line.tag->parameter_count == 0 && line.tag->measurement == 3 &&
         line.tag->angles == 0b100 && line.tag->information == 3 && line.ids[0] != line.ids[1];
}

PlanarEdges planar_edges(const RawGraph& graph) {
  PlanarEdges planar;
  IdMap<std::uint32_t> index_of;
  const auto index = [&](std::uint64_t id) {
    const auto [found, added] =
        index_of.emplace(id, static_cast<std::uint32_t>(planar.poses.size()));
    if (added) planar.poses.emplace_back();
    return found->second;
  };
  for (std::size_t l = 0; l < graph.lines.size(); ++l) {
    const RawLine& line = graph.lines[l];
    const bool vertex =
        !line.broken && line.tag->role == TagRole::kVertex && line.tag->angles == 0b100;
    if (!vertex && !is_planar_edge(graph, line)) continue;
    const auto numbers = graph.measurement(line);
    const RawPose2 pose{numbers[0], numbers[1], numbers[2]};
    if (vertex) {
      planar.poses[index(line.ids[0])] = pose;
      continue;
    }
    RawEdge2 edge{index(line.ids[0]), index(line.ids[1]), pose, {1.0, 0.0, 0.0, 1.0, 0.0, 1.0}};
    const auto information = graph.information(line);
    if (information.size() == 6) std::copy_n(information.begin(), 6, edge.information.begin());
    planar.edges.push_back(edge);
    planar.lines.push_back(l);
  }
  return planar;
}

void report_degrees(const RawLine& line, const std::string& whose, const std::string& evidence,
                    Findings& findings) {
  const auto column = static_cast<std::size_t>(line.tag->measurement - 1);
  findings.add(CheckCode::kDegrees, line.line, number_field(line, column).column,
               "the angles of the " + whose + " look like degrees, expected radians: " + evidence,
               "multiply them by pi / 180; information about angles is per rad^2");
}

const RawLine* first_line_of(const RawGraph& graph, TagRole role) {
  const auto found = std::find_if(graph.lines.begin(), graph.lines.end(), [&](const RawLine& line) {
    return !line.broken && line.tag->role == role && line.tag->angles == 0b100;
  });
  return found == graph.lines.end() ? nullptr : &*found;
}

void check_planar_degrees(const RawGraph& graph, const PlanarEdges& planar, Findings& findings) {
  const DegreesVerdict verdict = judge_angle_units(planar.poses, planar.edges);
  if (!verdict.vertices && !verdict.edges) return;
  const std::string evidence =
      "read as degrees, the median disagreement between edges and vertices falls from " +
      readable(verdict.misfit_as_radians) + " to " + readable(verdict.misfit_as_degrees);
  const RawLine* line = first_line_of(graph, verdict.vertices ? TagRole::kVertex : TagRole::kEdge);
  if (!line) return;
  const std::string whose = !verdict.edges     ? "vertices"
                            : verdict.vertices ? "vertices and edges"
                                               : "edges";
  report_degrees(
      *line, whose,
      verdict.misfit_as_radians > 0.0 ? evidence : "more than a tenth is beyond half a turn",
      findings);
}

// Angles that stand alone (bearings, roll pitch yaw): only their size tells.
void check_other_degrees(const RawGraph& graph, Findings& findings) {
  for (const TagSpec& tag : graph_tags(graph.format)) {
    if (tag.role != TagRole::kEdge || tag.angles == 0 || tag.angles == 0b100) continue;
    std::size_t lines = 0, beyond = 0;
    double largest = 0.0;
    const RawLine* first = nullptr;
    for (const RawLine& line : graph.lines) {
      if (line.broken || line.tag != &tag) continue;
      double magnitude = 0.0;
      const auto numbers = graph.measurement(line);
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (tag.angles >> k & 1U) magnitude = std::max(magnitude, std::abs(numbers[k]));
      }
      ++lines;
      largest = std::max(largest, magnitude);
      if (magnitude <= 1.001 * std::numbers::pi) continue;
      ++beyond;
      if (!first) first = &line;
    }
    if (beyond >= 3 && 10 * beyond > lines && largest <= 360.5) {
      report_degrees(*first, std::string(tag.name) + " lines",
                     std::to_string(beyond) + " of " + std::to_string(lines) +
                         " are beyond half a turn, the largest is " + readable(largest),
                     findings);
    }
  }
}

std::string order_name(PlanarOrder order) {
  return order == PlanarOrder::kToro ? "TORO's order (xx xy yy tt xt yt)"
                                     : "g2o's order (xx xy xt yy yt tt)";
}

void swap_order(RawGraph& graph, const PlanarEdges& planar, PlanarOrder given, Repairs& repairs) {
  for (std::size_t e = 0; e < planar.edges.size(); ++e) {
    RawLine& line = graph.lines[planar.lines[e]];
    line.broken = true;
    if (graph.information(line).empty()) continue;
    const auto numbers = reorder_planar_information(planar.edges[e].information, given);
    std::vector<Repairs::Replacement> parts;
    for (std::size_t k = 0; k < 6; ++k)
      parts.push_back({number_field(line, 3 + k).text, shortest(numbers[k])});
    repairs.replace(CheckCode::kInformationOrder, line.line, parts,
                    "wrote the information in " + order_name(given));
  }
}

void check_order(RawGraph& graph, const PlanarEdges& planar, Findings& findings, Repairs& repairs) {
  if (planar.edges.empty()) return;
  const InformationLayout layout = graph.lines[planar.lines[0]].tag->layout;
  if (layout == InformationLayout::kSquareRootFactor) return;
  const bool toro = layout == InformationLayout::kToro2;
  const PlanarOrder given = toro ? PlanarOrder::kToro : PlanarOrder::kRowMajor;
  const PlanarOrder other = toro ? PlanarOrder::kRowMajor : PlanarOrder::kToro;
  const OrderVerdict verdict = judge_information_order(planar.poses, planar.edges, given);
  if (verdict == OrderVerdict::kAsGiven) return;
  const RawLine& line = graph.lines[planar.lines[0]];
  const std::size_t column = number_field(line, 3).column;
  if (verdict == OrderVerdict::kPlausible) {
    findings.add(CheckCode::kInformationOrderPlausible, line.line, column,
                 "the residuals fit the information much better when it is read in " +
                     order_name(other) + " than in " + order_name(given),
                 "compare the columns with what the writing program documents");
    return;
  }
  findings.add(CheckCode::kInformationOrder, line.line, column,
               "the information of " + std::to_string(planar.edges.size()) + " " +
                   std::string(line.tag->name) + " lines is in " + order_name(other) +
                   ", expected " + order_name(given) +
                   ": as it is most are not positive semidefinite, in the other order all are",
               "--fix writes them in the expected order");
  swap_order(graph, planar, given, repairs);
}

}  // namespace

void check_values(RawGraph& graph, Findings& findings, Repairs& repairs) {
  for (RawLine& line : graph.lines) {
    if (!line.broken && line.tag->quaternion >= 0) check_quaternion(graph, line, findings, repairs);
  }
  check_quaternion_order(graph, findings);
  const PlanarEdges planar = planar_edges(graph);
  check_planar_degrees(graph, planar, findings);
  check_other_degrees(graph, findings);
  check_order(graph, planar, findings, repairs);
  check_information(graph, findings, repairs);
}

}  // namespace cairn
