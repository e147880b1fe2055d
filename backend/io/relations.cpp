// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/relations.hpp"

#include <map>
#include <optional>

#include "cairn/io/input_text.hpp"
#include "cairn/io/number_line.hpp"
#include "cairn/io/roll_pitch_yaw.hpp"

namespace cairn {
namespace {

constexpr std::size_t kFields = 8;

Result<Relation> read_relation(const Record& record, std::string_view file) {
  const auto fields =
      split<kFields>(record, file, "a relation has 8 numbers (t1 t2 x y z roll pitch yaw)");
  if (!fields) return fields.error();
  const Result<std::uint64_t> from = stamp_in((*fields)[0], record, file);
  if (!from) return from.error();
  const Result<std::uint64_t> to = stamp_in((*fields)[1], record, file);
  if (!to) return to.error();
  std::array<double, kFields> v;
  for (std::size_t i = 2; i < kFields; ++i) {
    const Result<double> number = number_in((*fields)[i], record, file);
    if (!number) return number.error();
    v[i] = *number;
  }
  return Relation{*from,
                  *to,
                  {rotation_from_roll_pitch_yaw({v[5], v[6], v[7]}), {v[2], v[3], v[4]}},
                  record.line_number};
}

// A log with its graph: VERTEX2 id x y theta, the ROBOTLASER1 it was seen with, EDGE2 a b x y theta
// and six numbers of information.
class GraphLog {
 public:
  explicit GraphLog(const std::string& name) : name_(name) {}

  Result<void> add(const Record& record) {
    if (record.tag == "VERTEX2") return add_vertex(record);
    if (record.tag == "ROBOTLASER1") return add_scan(record);
    if (record.tag == "EDGE2") return add_edge(record);
    return fail(record, record.tag,
                "'" + quote(record.tag) +
                    "' does not belong into a log with its graph; VERTEX2, "
                    "ROBOTLASER1 and EDGE2 do");
  }

  // Edges may stand before their vertices, so stamps come last.
  Result<Relations> finish() {
    Relations result{.name = name_};
    for (const Edge& edge : edges_) {
      const Result<Vertex> a = find(edge, 0), b = find(edge, 1);
      if (!a || !b) return a ? b.error() : a.error();
      if (a->order + 1 == b->order || b->order + 1 == a->order) continue;
      result.relations.push_back({a->stamp_ns, b->stamp_ns, edge.T_a_b, edge.line});
    }
    return result;
  }

 private:
  struct Vertex {
    std::size_t order;
    std::uint64_t stamp_ns;
  };
  struct Edge {
    std::array<std::uint64_t, 2> ids;
    std::array<std::size_t, 2> columns;
    Se3 T_a_b;
    std::size_t line;
  };

  Error fail(const Record& record, std::string_view where, std::string message) const {
    return error_at(record, name_, record.column_of(where.data()), std::move(message));
  }

  Result<void> add_vertex(const Record& record) {
    std::array<std::uint64_t, 1> id;
    std::array<double, 3> ignored;
    if (auto read = read_fields(record, name_, id, ignored); !read) return read;
    pending_ = id[0];
    return {};
  }

  Result<void> add_scan(const Record& record) {
    if (!pending_)
      return fail(record, record.tag, "a scan without a VERTEX2 before it; of which pose is it?");
    // ... stamp host logger_stamp
    const std::size_t fields = count_fields(record);
    if (fields < 3) return fail(record, record.tag, "the scan is cut short");
    const Field field = *field_at(record, fields - 3);
    const Result<std::uint64_t> stamp = stamp_in(field, record, name_);
    if (!stamp) return stamp.error();
    if (!vertices_.emplace(*pending_, Vertex{vertices_.size(), *stamp}).second)
      return fail(record, record.tag, "vertex " + std::to_string(*pending_) + " is defined twice");
    pending_.reset();
    return {};
  }

  Result<void> add_edge(const Record& record) {
    Edge edge{.ids = {}, .columns = {}, .T_a_b = {}, .line = record.line_number};
    std::array<double, 9> v;
    if (auto read = read_fields(record, name_, edge.ids, v); !read) return read;
    for (std::size_t i = 0; i < 2; ++i) edge.columns[i] = field_at(record, i)->column;
    edge.T_a_b = Se3(So3::exp({0.0, 0.0, v[2]}), {v[0], v[1], 0.0});
    edges_.push_back(edge);
    return {};
  }

  Result<Vertex> find(const Edge& edge, std::size_t end) const {
    const auto found = vertices_.find(edge.ids[end]);
    if (found != vertices_.end()) return found->second;
    return Error{
        ErrorCode::kBadInput,
        "vertex " + std::to_string(edge.ids[end]) +
            " has no stamp; a VERTEX2 line and the ROBOTLASER1 line behind it are expected",
        place_in(name_, edge.line, edge.columns[end])};
  }

  std::string name_;
  std::optional<std::uint64_t> pending_;  // a vertex whose scan has not come yet
  std::map<std::uint64_t, Vertex> vertices_;
  std::vector<Edge> edges_;
};

bool begins_a_graph_log(const Record& record) {
  return record.tag == "VERTEX2" || record.tag == "ROBOTLASER1" || record.tag == "EDGE2";
}

}  // namespace

Result<Relations> read_relations_text(std::string_view text, const std::string& name) {
  RecordScanner scanner(text);
  Record record;
  Relations result{.name = name};
  std::optional<GraphLog> log;
  while (scanner.next(record)) {
    if (!log && result.relations.empty() && begins_a_graph_log(record)) log.emplace(name);
    if (log) {
      if (const Result<void> added = log->add(record); !added) return added.error();
      continue;
    }
    const Result<Relation> relation = read_relation(record, name);
    if (!relation) return relation.error();
    result.relations.push_back(*relation);
  }
  if (log) {
    Result<Relations> loops = log->finish();
    if (!loops) return loops;
    result = std::move(*loops);
  }
  if (result.relations.empty()) {
    return Error{ErrorCode::kBadInput,
                 log ? "holds no loops: every EDGE2 joins scans that follow each other"
                     : "holds no relations",
                 place_in(name, 1, 1)};
  }
  return result;
}

Result<Relations> read_relations(const std::string& path) {
  const Result<InputText> text = read_input_text(path);
  if (!text) return text.error();
  return read_relations_text(text->view, input_name(path));
}

}  // namespace cairn
