// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cmath>

#include "cairn/io/edge_encoder.hpp"
#include "cairn/io/equivalence.hpp"
#include "cairn/io/graph_tags.hpp"
#include "cairn/io/record_scanner.hpp"

namespace cairn {
namespace {

// Text with the shortest digits that read back as the same number.
class LineText {
 public:
  void reserve(std::size_t bytes) { text_.reserve(bytes); }
  LineText& tag(std::string_view tag) {
    text_ += tag;
    return *this;
  }
  template <class Number>
  LineText& add(Number number) {
    char digits[40];
    digits[0] = ' ';
    const char* end = std::to_chars(digits + 1, digits + sizeof digits, number).ptr;
    text_.append(digits, static_cast<std::size_t>(end - digits));
    return *this;
  }
  LineText& add(const std::vector<double>& numbers) {
    for (const double number : numbers) add(number);
    return *this;
  }
  void end() { text_ += '\n'; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

bool is_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

// The ids that EQUIV lines merged into another one, each with the variable it names now.
std::vector<std::pair<VariableId, VariableSlot>> merged_names(const GraphDocument& document) {
  Equivalence equivalence;
  for (const auto& [a, b] : document.equivalences) equivalence.merge(a, b);
  std::vector<std::pair<VariableId, VariableSlot>> names;
  for (const auto& pair : document.equivalences) {
    for (const VariableId id : {pair.first, pair.second}) {
      const auto slot = document.graph.find(equivalence.root(id));
      if (slot && !document.graph.find(id)) names.emplace_back(id, *slot);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

class GraphWriter {
  // Of an entry of the information, relative to the roots of its diagonal entries.
  static constexpr double kLargestInformationError = 1e-9;

 public:
  GraphWriter(const GraphDocument& document, GraphFormat format)
      : document_(document), graph_(document.graph), format_(format), offsets_(document) {}

  Result<std::string> write() {
    if (format_ == GraphFormat::kDlr) return refuse("the dlr format is read only; choose g2o");
    if (Result<void> fits = check_unknown_lines(); !fits) return fits.error();
    if (Result<void> written = write_edges(); !written) return written.error();
    const std::string edges = text_.take();
    write_parameters();
    if (Result<void> written = write_vertices(); !written) return written.error();
    write_fixed();
    text_.tag(edges);
    write_equivalences();
    for (const std::string& line : document_.unknown_lines) text_.tag(line).end();
    return text_.take();
  }

 private:
  [[nodiscard]] Error refuse(const std::string& why) const { return {ErrorCode::kUsage, why}; }
  [[nodiscard]] std::string format_name() const { return std::string(to_string(format_)); }
  [[nodiscard]] std::uint64_t id_of(VariableSlot slot) const {
    return graph_.variables()[slot].id.value;
  }

  // A line that is unknown to one format may mean something in another.
  Result<void> check_unknown_lines() const {
    if (format_ == document_.format) return {};
    for (const std::string& line : document_.unknown_lines) {
      RecordScanner scanner(line);
      Record record;
      if (!scanner.next(record)) continue;
      for (const GraphFormat other : {GraphFormat::kG2o, GraphFormat::kToro, GraphFormat::kIsam}) {
        if (!find_tag(other, record.tag)) continue;
        return refuse("the unknown line '" + quote(line) + "' would get a meaning in " +
                      format_name() + " format; remove it first");
      }
    }
    return {};
  }

  void write_parameters() {
    if (format_ != GraphFormat::kG2o) return;
    std::vector<double> columns;
    for (const auto& [id, offset] : offsets_.offsets2()) {
      columns.clear();
      append_se2(offset, columns);
      text_.tag("PARAMS_SE2OFFSET").add(id.value).add(columns).end();
    }
    for (const auto& [id, offset] : offsets_.offsets3()) {
      columns.clear();
      append_se3_quaternion(offset, columns);
      text_.tag("PARAMS_SE3OFFSET").add(id.value).add(columns).end();
    }
  }

  Result<void> write_vertices() {
    if (format_ == GraphFormat::kIsam) return check_mentioned();
    constexpr std::string_view kG2oTags[] = {"VERTEX_SE2", "VERTEX_SE3:QUAT", "VERTEX_XY",
                                             "VERTEX_TRACKXYZ"};
    constexpr std::string_view kToroTags[] = {"VERTEX2", "VERTEX3", "", ""};
    const auto& tags = format_ == GraphFormat::kG2o ? kG2oTags : kToroTags;
    for (const Variable& variable : graph_.variables()) {
      const std::string_view tag = tags[static_cast<std::size_t>(variable.type)];
      if (tag.empty()) {
        return refuse(format_name() + " format cannot hold landmarks (vertex " +
                      std::to_string(variable.id.value) + "); choose g2o");
      }
      write_vertex(tag, variable.id, variable);
      if (!is_finite(columns_)) {
        return refuse("vertex " + std::to_string(variable.id.value) +
                      " has a value that is not finite; its edges hold numbers beyond all measure");
      }
    }
    for (const auto& [name, slot] : aliases_) {
      const Variable& variable = graph_.variables()[slot];
      write_vertex(tags[static_cast<std::size_t>(variable.type)], name, variable);
    }
    return {};
  }

  void write_vertex(std::string_view tag, VariableId id, const Variable& variable) {
    columns_.clear();
    const Values& values = graph_.values();
    switch (variable.type) {
      case VariableType::kPose2:
        append_se2(values.pose2[variable.index], columns_);
        break;
      case VariableType::kPose3:
        format_ == GraphFormat::kG2o
            ? append_se3_quaternion(values.pose3[variable.index], columns_)
            : append_se3_roll_pitch_yaw(values.pose3[variable.index], columns_);
        break;
      case VariableType::kPoint2: {
        const Eigen::Vector2d& p = values.point2[variable.index];
        columns_.assign(p.data(), p.data() + 2);
        break;
      }
      case VariableType::kPoint3: {
        const Eigen::Vector3d& p = values.point3[variable.index];
        columns_.assign(p.data(), p.data() + 3);
        break;
      }
    }
    text_.tag(tag).add(id.value).add(columns_).end();
  }

  // iSAM files have no vertices: a variable exists by its edges.
  Result<void> check_mentioned() const {
    std::vector<bool> mentioned(graph_.variables().size());
    for (const FactorRef factor : graph_.factors()) {
      for (const VariableSlot slot : graph_.slots_of(factor)) mentioned[slot] = true;
    }
    const auto lone = std::find(mentioned.begin(), mentioned.end(), false);
    if (lone == mentioned.end()) return {};
    return refuse("isam format cannot hold vertex " +
                  std::to_string(id_of(static_cast<VariableSlot>(lone - mentioned.begin()))) +
                  ", which has no edge; choose g2o");
  }

  void write_fixed() {
    for (const Variable& variable : graph_.variables()) {
      if (variable.fixed) text_.tag("FIX").add(variable.id.value).end();
    }
  }

  Result<void> write_edges() {
    std::vector<EncodeFactor> encoders;
    for (const auto& batch : graph_.batches()) encoders.push_back(edge_encoder(*batch));
    EdgeLine line;
    for (const FactorRef factor : graph_.factors()) {
      const FactorBatch& batch = *graph_.batches()[factor.batch];
      const EncodeFactor encode = encoders[factor.batch];
      if (!encode || !encode(batch, factor.index, format_, offsets_, line)) {
        return refuse(format_name() + " format cannot hold factors of type " +
                      std::string(batch.type_name()) +
                      (format_ == GraphFormat::kG2o ? "" : "; choose g2o"));
      }
      text_.tag(line.tag);
      for (const VariableSlot slot : graph_.slots_of(factor)) text_.add(id_of(slot));
      for (const ParameterId parameter : line.parameters) text_.add(parameter.value);
      if (!is_finite(line.numbers)) {
        return refuse("a factor of type " + std::string(batch.type_name()) +
                      " holds a number that is not finite");
      }
      if (!(line.information_error <= kLargestInformationError)) return refuse_information(factor);
      text_.add(line.numbers).end();
    }
    return {};
  }

  [[nodiscard]] Error refuse_information(const FactorRef factor) const {
    std::string vertices;
    for (const VariableSlot slot : graph_.slots_of(factor))
      vertices += (vertices.empty() ? "" : " and ") + std::to_string(id_of(slot));
    return refuse("the information of the factor on vertices " + vertices +
                  " is too near to singular for the square root that " + format_name() +
                  " format holds; choose g2o");
  }

  void write_equivalences() {
    for (const auto& [a, b] : document_.equivalences)
      text_.tag("EQUIV").add(a.value).add(b.value).end();
  }

  const GraphDocument& document_;
  const Graph& graph_;
  GraphFormat format_;
  OffsetNames offsets_;
  std::vector<std::pair<VariableId, VariableSlot>> aliases_ = merged_names(document_);
  LineText text_;
  std::vector<double> columns_;
};

}  // namespace

Result<std::string> write_graph_text(const GraphDocument& document, GraphFormat format) {
  return GraphWriter(document, format).write();
}

}  // namespace cairn
