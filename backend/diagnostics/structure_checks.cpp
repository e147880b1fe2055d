// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/structure_checks.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "cairn/io/equivalence.hpp"

namespace cairn {
namespace {

std::string name_of(std::uint64_t id) { return std::to_string(id); }

class Checker {
 public:
  Checker(RawGraph& graph, Findings& findings, Repairs& repairs)
      : graph_(graph), findings_(findings), repairs_(repairs) {}

  RawStructure run() {
    for (RawLine& line : graph_.lines) define(line);
    for (const RawLine& line : graph_.lines) {
      if (line.tag->role == TagRole::kEquivalence) merge(line);
    }
    for (RawLine& line : graph_.lines) {
      if (graph_.is_edge(line)) check_edge(line);
    }
    report_dangling();
    report_parallel();
    report_mixed_dimensions();
    check_fixes();
    report_gaps();
    return std::move(structure_);
  }

 private:
  void define(RawLine& line) {
    if (line.tag->role == TagRole::kParameter) return define_parameter(line);
    if (line.tag->role != TagRole::kVertex) return;
    has_vertices_[static_cast<std::size_t>(line.tag->variables[0])][line.ids[0] >> 56] = true;
    const auto [found, added] = structure_.vertices.emplace(
        line.ids[0], RawStructure::Vertex{
                         .type = line.tag->variables[0], .line = line.line, .broken = line.broken});
    if (added) {
      lines_of_vertices_.emplace(line.ids[0], &line);
      return;
    }
    report_repeated(*lines_of_vertices_.at(line.ids[0]), line);
  }

  void define_parameter(RawLine& line) {
    const auto [found, added] =
        parameters_.emplace(std::pair(line.tag->quaternion >= 0, line.ids[0]), &line);
    if (!added) report_repeated(*found->second, line);
  }

  void report_repeated(const RawLine& first, RawLine& second) {
    const std::string where =
        describe(second) + " is defined in line " + std::to_string(first.line);
    const bool alike = !first.broken && !second.broken && same_content(first, second);
    second.broken = second.unusable = true;
    if (alike) {
      findings_.add(CheckCode::kVertexRepeated, second.line, 1,
                    where + " already, with the same numbers", "delete one of the lines");
      repairs_.drop(CheckCode::kVertexRepeated, second.line, second.text,
                    "dropped the copy of " + describe(second));
    } else {
      findings_.add(CheckCode::kVertexRedefined, second.line, id_field(second, 0).column,
                    where + " already, differently",
                    "give one of them an id of its own, or delete the wrong line");
    }
  }

  bool same_content(const RawLine& a, const RawLine& b) const {
    if (a.tag != b.tag || a.ids != b.ids || a.number_count != b.number_count) return false;
    const auto begin = graph_.numbers.begin();
    return std::equal(begin + static_cast<std::ptrdiff_t>(a.first_number),
                      begin + static_cast<std::ptrdiff_t>(a.first_number + a.number_count),
                      begin + static_cast<std::ptrdiff_t>(b.first_number));
  }

  // EQUIV a b: one pose under two ids.
  void merge(const RawLine& line) {
    equivalence_.merge(VariableId{line.ids[0]}, VariableId{line.ids[1]});
    const auto a = structure_.vertices.find(line.ids[0]);
    const auto b = structure_.vertices.find(line.ids[1]);
    if (a != structure_.vertices.end() && b == structure_.vertices.end()) {
      const RawStructure::Vertex copy = a->second;
      structure_.vertices.emplace(line.ids[1], copy);
    } else if (b != structure_.vertices.end() && a == structure_.vertices.end()) {
      const RawStructure::Vertex copy = b->second;
      structure_.vertices.emplace(line.ids[0], copy);
    }
  }

  void check_edge(RawLine& line) {
    if (line.tag->variable_count == 2 && line.ids[0] == line.ids[1]) {
      line.broken = line.unusable = true;
      findings_.add(CheckCode::kSelfEdge, line.line, id_field(line, 1).column,
                    describe(line) + " connects vertex " + name_of(line.ids[0]) +
                        " with itself, expected two different vertices",
                    "it says nothing about the graph: delete it");
      repairs_.drop(CheckCode::kSelfEdge, line.line, line.text,
                    "dropped " + describe(line) + ": from a vertex to itself");
      return;
    }
    if (line.tag->variable_count == 2 &&
        equivalence_.root(VariableId{line.ids[0]}) == equivalence_.root(VariableId{line.ids[1]})) {
      findings_.add(CheckCode::kEdgeWithinPose, line.line, id_field(line, 1).column,
                    describe(line) + " connects two ids of one pose (EQUIV): it is left out",
                    "delete it");
    }
    check_parameters(line);
    if (!check_types(line)) return;
    for (const std::uint64_t id : graph_.variables(line)) {
      RawStructure::Vertex& vertex = structure_.vertices.find(id).value();
      if (vertex.edges++ == 0) vertex.first_edge = line.line;
    }
    if (!line.broken) check_copies(line);
  }

  bool check_types(RawLine& line) {
    for (std::size_t k = 0; k < graph_.variables(line).size(); ++k) {
      const VariableType expected = line.tag->variables[k];
      const auto [found, added] =
          structure_.vertices.emplace(line.ids[k], RawStructure::Vertex{.type = expected});
      if (added) inferred_.push_back({line.ids[k], &line, k});
      if (found->second.type == expected) continue;
      line.broken = line.unusable = true;
      mistyped_ = true;
      findings_.add(
          CheckCode::kWrongType, line.line, id_field(line, k).column,
          std::string(line.tag->name) + " needs a " + std::string(to_string(expected)) +
              " here, but vertex " + name_of(line.ids[k]) + " is a " +
              std::string(to_string(found->second.type)) +
              (found->second.line > 0 ? " (line " + std::to_string(found->second.line) + ")"
                                      : std::string()),
          "check the order of the ids, or the tag");
      return false;
    }
    return true;
  }

  void check_parameters(RawLine& line) {
    for (int p = 0; p < line.tag->parameter_count; ++p) {
      const std::size_t k = static_cast<std::size_t>(line.tag->variable_count + p);
      const bool spatial = line.tag->variables[0] == VariableType::kPose3;
      if (line.unusable || parameters_.contains({spatial, line.ids[k]})) continue;
      line.broken = line.unusable = true;
      const auto id = std::to_string(static_cast<std::int64_t>(line.ids[k]));
      findings_.add(CheckCode::kMissingParameter, line.line, id_field(line, k).column,
                    describe(line) + " uses sensor offset " + id + ", which no line defines",
                    std::string("add a line PARAMS_SE") + (spatial ? "3OFFSET " : "2OFFSET ") + id +
                        (spatial ? " 0 0 0 0 0 0 1" : " 0 0 0") +
                        " if the sensor is at the body's origin");
    }
  }

  std::size_t content_hash(const RawLine& line) const {
    const std::string_view bytes(
        reinterpret_cast<const char*>(graph_.numbers.data() + line.first_number),
        line.number_count * sizeof(double));
    std::size_t hash = std::hash<std::string_view>()(bytes);
    for (const std::uint64_t id : line.ids)
      hash = hash * 0x9E3779B97F4A7C15ULL + static_cast<std::size_t>(id);
    return hash;
  }

  void check_copies(const RawLine& line) {
    const auto [found, added] = first_of_content_.emplace(content_hash(line), &line);
    if (!added && same_content(*found->second, line)) {
      findings_.add(CheckCode::kDuplicateEdge, line.line, 1,
                    describe(line) + " repeats line " + std::to_string(found->second->line) +
                        " number by number, so it counts twice",
                    "delete one of the lines, unless the measurement was really made twice");
      repairs_.drop(CheckCode::kDuplicateEdge, line.line, line.text,
                    "dropped the copy of " + describe(line) + " in line " +
                        std::to_string(found->second->line));
      return;
    }
    if (line.tag->variable_count != 2) return;
    const auto pair = std::minmax(line.ids[0], line.ids[1]);
    const std::size_t key = std::hash<std::string_view>()(line.tag->name) ^
                            (pair.first * 0x9E3779B97F4A7C15ULL + pair.second);
    const auto [same_pair, first] = first_of_pair_.emplace(key, &line);
    if (first) return;
    if (parallel_++ == 0) first_parallel_ = &line, parallel_to_ = same_pair->second;
  }

  // The readers take a file that leaves out all vertices of one type and robot; one that leaves out
  // some is damaged.
  [[nodiscard]] bool may_be_left_out(std::uint64_t id, VariableType type) const {
    return !has_vertices_[static_cast<std::size_t>(type)][id >> 56];
  }

  void report_left_out() {
    std::size_t count = 0;
    const Inferred* first = nullptr;
    for (const Inferred& inferred : inferred_) {
      if (!may_be_left_out(inferred.id, structure_.vertices.at(inferred.id).type)) continue;
      if (count++ == 0) first = &inferred;
    }
    if (count == 0 || graph_.format == GraphFormat::kIsam) return;
    const std::string number = std::to_string(count);
    if (count == structure_.vertices.size()) {
      findings_.add(CheckCode::kNoVertices, first->line->line, 1,
                    "the file has edges only: its " + number +
                        " vertices start where a chain of edges puts them",
                    "nothing to do; cairn optimize --init auto looks for a better start");
    } else {
      findings_.add(CheckCode::kVerticesLeftOut, first->line->line, 1,
                    number +
                        (count == 1 ? " vertex has no line of its own ("
                                    : " vertices have no line of their own (first: ") +
                        name_of(first->id) + ") and start" + (count == 1 ? "s" : "") +
                        " where the edges say",
                    "give the file that defines them too, or add their lines");
    }
  }

  void report_dangling() {
    report_left_out();
    for (const auto& [id, line, k] : inferred_) {
      const RawStructure::Vertex& vertex = structure_.vertices.at(id);
      if (may_be_left_out(id, vertex.type)) continue;
      structure_.dangling.push_back(id);
      const bool leaf = vertex.edges == 1;
      findings_.add(CheckCode::kDanglingId, line->line, id_field(*line, k).column,
                    describe(*line) + " names vertex " + name_of(id) +
                        ", which no line defines, though others of its kind are defined",
                    leaf ? "add its vertex line or delete the edge (--fix deletes it: no other "
                           "edge knows the vertex)"
                         : "add its vertex line (--fix does, where its " +
                               std::to_string(vertex.edges) + " edges put it)");
      if (leaf && !line->broken) {
        repairs_.drop(CheckCode::kDanglingId, line->line, line->text,
                      "dropped " + describe(*line) + ": nothing else knows vertex " + name_of(id));
      }
    }
  }

  void report_parallel() {
    if (parallel_ == 0) return;
    findings_.add(
        CheckCode::kParallelEdges, first_parallel_->line, 1,
        describe(*first_parallel_) + " connects the same vertices as line " +
            std::to_string(parallel_to_->line) + ", with other numbers" +
            (parallel_ > 1 ? " (and " + std::to_string(parallel_ - 1) + " more such edges)"
                           : std::string()),
        "nothing to do if they are separate measurements");
  }

  void report_mixed_dimensions() {
    std::uint32_t line_of_planar = 0, line_of_spatial = 0;
    for (const auto& [id, vertex] : structure_.vertices) {
      const bool planar =
          vertex.type == VariableType::kPose2 || vertex.type == VariableType::kPoint2;
      std::uint32_t& line = planar ? line_of_planar : line_of_spatial;
      const std::uint32_t own = vertex.line ? vertex.line : vertex.first_edge;
      line = line == 0 ? own : std::min(line, own);
    }
    if (line_of_planar == 0 || line_of_spatial == 0 || mistyped_) return;
    findings_.add(CheckCode::kPlanarAndSpatial, std::max(line_of_planar, line_of_spatial), 1,
                  "the file has vertices in the plane and in space (first in lines " +
                      std::to_string(std::min(line_of_planar, line_of_spatial)) + " and " +
                      std::to_string(std::max(line_of_planar, line_of_spatial)) +
                      "), which no edge can connect",
                  "split it into two files");
  }

  void check_fixes() {
    std::map<std::uint32_t, std::size_t> sound;  // ids per line that can be fixed
    for (RawFix& fix : graph_.fixes)
      sound[fix.line] += !fix.broken && structure_.vertices.contains(fix.id);
    for (RawFix& fix : graph_.fixes) {
      if (fix.broken || structure_.vertices.contains(fix.id)) continue;
      fix.broken = true;
      findings_.add(
          CheckCode::kFixUnknown, fix.line, fix.field.column,
          "FIX names vertex " + name_of(fix.id) + ", which neither a vertex nor an edge line knows",
          "correct the id or delete it");
      const std::string what = "dropped FIX of unknown vertex " + name_of(fix.id);
      if (sound[fix.line] == 0) {
        repairs_.drop(CheckCode::kFixUnknown, fix.line, fix.text, what);
      } else {
        repairs_.replace(CheckCode::kFixUnknown, fix.line, {{fix.field.text, ""}}, what);
      }
    }
  }

  // Consecutive poses of one robot are usually tied by odometry; where nearly all are, the others
  // surprise.
  void report_gaps() {
    const bool edges_only = lines_of_vertices_.empty();
    std::vector<std::uint64_t> poses;
    for (const auto& [id, vertex] : structure_.vertices) {
      if (is_pose(vertex.type) && (vertex.line > 0 || edges_only)) poses.push_back(id);
    }
    std::sort(poses.begin(), poses.end());
    std::vector<std::pair<std::uint64_t, std::uint64_t>> tied;
    for (const RawLine& line : graph_.lines) {
      if (line.tag->variable_count == 2) tied.push_back(std::minmax(line.ids[0], line.ids[1]));
    }
    std::sort(tied.begin(), tied.end());
    std::size_t neighbors = 0;
    std::vector<std::size_t> gaps;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      if (poses[i - 1] >> 56 != poses[i] >> 56) continue;  // another robot
      ++neighbors;
      if (!std::binary_search(tied.begin(), tied.end(), std::pair(poses[i - 1], poses[i])))
        gaps.push_back(i);
    }
    if (gaps.empty() || 10 * gaps.size() > neighbors) return;
    const std::uint64_t before = poses[gaps[0] - 1], behind = poses[gaps[0]];
    findings_.add(
        CheckCode::kOdometryGap, structure_.line_of(behind), 1,
        "no edge ties poses " + name_of(before) + " and " + name_of(behind) +
            ", though nearly all consecutive poses are tied" +
            (gaps.size() > 1 ? " (and " + std::to_string(gaps.size() - 1) + " more such gaps)"
                             : std::string()),
        "nothing to do if odometry was lost there");
  }

  struct Inferred {
    std::uint64_t id;
    const RawLine* line;
    std::size_t k;
  };

  RawGraph& graph_;
  Findings& findings_;
  Repairs& repairs_;
  RawStructure structure_;
  std::array<std::array<bool, 256>, 4> has_vertices_{};  // type, robot (top byte of the id)
  IdMap<RawLine*> lines_of_vertices_;
  std::map<std::pair<bool, std::uint64_t>, RawLine*> parameters_;  // (in space, id)
  Equivalence equivalence_;
  std::vector<Inferred> inferred_;
  IdMap<const RawLine*> first_of_content_;
  IdMap<const RawLine*> first_of_pair_;
  std::size_t parallel_ = 0;
  const RawLine* first_parallel_ = nullptr;
  const RawLine* parallel_to_ = nullptr;
  bool mistyped_ = false;
};

}  // namespace

std::uint32_t RawStructure::line_of(std::uint64_t id) const {
  const auto found = vertices.find(id);
  if (found == vertices.end()) return 0;
  return found->second.line ? found->second.line : found->second.first_edge;
}

RawStructure check_structure(RawGraph& graph, Findings& findings, Repairs& repairs) {
  return Checker(graph, findings, repairs).run();
}

}  // namespace cairn
