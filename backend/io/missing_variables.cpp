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
    std::vector<std::pair<VariableId, VariableType>> missing(types_.begin(), types_.end());
    std::sort(missing.begin(), missing.end());
    for (const auto& [id, type] : missing) {
      if (!add_at_origin(id, type))
        return Error{ErrorCode::kInternal, "a missing variable is not missing"};
    }
    return warn_about(missing);
  }

 private:
  // Notes what the edges mention. Lines that do not parse are left to the edge reader.
  void collect(bool twins_only) {
    for (const GraphSource& source : reading_.sources) {
      (void)source.for_each(
          TagRole::kEdge, [&](const Record& record, const TagSpec& named) -> Result<void> {
            if (twins_only && !source.has_twin(named)) return {};
            const TagSpec* tag = fitting_tag(source, record, named, type_of_first(record));
            if (!tag) {
              waits_for_twins_ = true;  // its pose may be known once the other edges are
              return {};
            }
            for (int k = 0; k < tag->variable_count; ++k) {
              if (const auto id = find_id(record, k))
                note(*id, tag->variables[static_cast<std::size_t>(k)]);
            }
            return {};
          });
    }
  }

  std::optional<VariableType> type_of_first(const Record& record) const {
    const auto id = find_id(record, 0);
    if (!id) return std::nullopt;
    const VariableId root = reading_.equivalence.root(*id);
    if (const auto slot = graph().find(root)) return graph().variables()[*slot].type;
    const auto found = types_.find(root);
    return found == types_.end() ? std::nullopt : std::optional(found->second);
  }

  void note(VariableId id, VariableType type) {
    const VariableId root = reading_.equivalence.root(id);
    if (reading_.may_be_left_out(root, type) && !graph().find(root)) types_.emplace(root, type);
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
  Result<void> warn_about(const std::vector<std::pair<VariableId, VariableType>>& missing) {
    if (missing.empty() || missing.size() == graph().variables().size()) return {};
    const std::string count = std::to_string(missing.size());
    return reading_.warn(reading_.sources.front().name(),
                         count + (missing.size() == 1 ? " vertex has" : " vertices have") +
                             " no line, the first is " +
                             std::to_string(missing.front().first.value) +
                             "; the start is computed from the edges");
  }

  [[nodiscard]] const Graph& graph() const { return reading_.document.graph; }

  Reading& reading_;
  tsl::robin_map<VariableId, VariableType, std::hash<VariableId>> types_;
  bool waits_for_twins_ = false;
};

}  // namespace

Result<void> add_missing_variables(Reading& reading) { return MissingVariables(reading).add(); }

}  // namespace cairn
