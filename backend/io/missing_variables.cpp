// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cairn/io/reading.hpp"

namespace cairn {
namespace {

class MissingVariables {
 public:
  explicit MissingVariables(Reading& reading) : reading_(reading) {}

  Result<void> add() {
    collect(false);
    if (waits_for_twins_) collect(true);
    std::sort(missing_.begin(), missing_.end());
    make_room();
    for (const auto& [id, type] : missing_) {
      if (!add_at_origin(id, type))
        return Error{ErrorCode::kInternal, "a missing variable is not missing"};
    }
    return warn();
  }

 private:
  // Notes what the edges mention. Lines that do not parse are left to the edge reader.
  void collect(bool twins_only) {
    for (const GraphSource& source : reading_.sources) {
      (void)source.for_each(
          TagRole::kEdge, [&](const Record& record, const TagSpec& named) -> Result<void> {
            if (twins_only && !source.has_twin(named)) return {};
            const auto first = source.has_twin(named) ? type_of_first(record) : std::nullopt;
            if (const TagSpec* tag = fitting_tag(source, record, named, first)) {
              note(record, *tag);
            } else {
              waits_for_twins_ = true;  // its pose may be known once the other edges are
            }
            return {};
          });
    }
  }

  std::optional<VariableType> type_of_first(const Record& record) const {
    std::array<std::uint64_t, 1> id;
    if (!read_ids(record, id)) return std::nullopt;
    const VariableId root = reading_.equivalence.root({id[0]});
    if (const auto slot = graph().find(root)) return graph().variables()[*slot].type;
    const auto found = index_.find(root);
    return found ? std::optional(missing_[*found].second) : std::nullopt;
  }

  void note(const Record& record, const TagSpec& tag) {
    std::array<std::uint64_t, 2> ids;
    const auto count = static_cast<std::size_t>(tag.variable_count);
    if (!read_ids(record, std::span(ids).first(count))) return;
    for (std::size_t k = 0; k < count; ++k) {
      const VariableId root = reading_.equivalence.root({ids[k]});
      const VariableType type = tag.variables[k];
      if (!reading_.may_be_left_out(root, type) || graph().find(root)) continue;
      if (!index_.insert(root, static_cast<std::uint32_t>(missing_.size()))) continue;
      missing_.emplace_back(root, type);
      ++counts_[static_cast<std::size_t>(type)];
    }
  }

  void make_room() {
    Graph& graph = reading_.document.graph;
    std::array<std::size_t, 4> counts = counts_;
    for (const Variable& known : graph.variables()) ++counts[static_cast<std::size_t>(known.type)];
    for (std::size_t type = 0; type < counts.size(); ++type)
      graph.reserve_values(static_cast<VariableType>(type), counts[type]);
    graph.reserve(graph.variables().size() + missing_.size());
  }

  bool add_at_origin(VariableId id, VariableType type) {
    Graph& graph = reading_.document.graph;
    switch (type) {
      case VariableType::kPose2:
        return graph.add_pose2(id, {}).ok();
      case VariableType::kPose3:
        return graph.add_pose3(id, {}).ok();
      case VariableType::kPoint2:
        return graph.add_point2(id, Eigen::Vector2d::Zero()).ok();
      case VariableType::kPoint3:
        break;
    }
    return graph.add_point3(id, Eigen::Vector3d::Zero()).ok();
  }

  // Files with edges only are usual; leaving out a part of the vertices is worth a word.
  Result<void> warn() {
    if (missing_.empty() || missing_.size() == graph().variables().size()) return {};
    const std::string count = std::to_string(missing_.size());
    return reading_.warn(reading_.sources.front().name(),
                         count + (missing_.size() == 1 ? " vertex has" : " vertices have") +
                             " no line, the first is " +
                             std::to_string(missing_.front().first.value) +
                             "; the start is computed from the edges");
  }

  [[nodiscard]] const Graph& graph() const { return reading_.document.graph; }

  Reading& reading_;
  SlotIndex index_;  // of missing_
  std::vector<std::pair<VariableId, VariableType>> missing_;
  std::array<std::size_t, 4> counts_{};  // of missing_, by type
  bool waits_for_twins_ = false;
};

}  // namespace

Result<void> add_missing_variables(Reading& reading) { return MissingVariables(reading).add(); }

}  // namespace cairn
