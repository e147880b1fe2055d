// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/history/question.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {

/// What an export writes: the order of the nodes, and where each is, by place in that order.
struct ExportContent {
  PoseGraph map;
  CanonicalOrder order;
  std::vector<std::vector<double>> values;

  [[nodiscard]] const StoredNode& node_at(std::size_t place) const {
    return map.nodes[order.nodes[place]];
  }
};

/// The settled map or, with the option live, the one that the daemon publishes. kNotUsable where it
/// is empty or cannot be settled.
Result<ExportContent> collect_export(const Question& question, const Asked& asked);

/// The enabled part of the map as a g2o file whose ids are `ids`, by place in the order.
Result<std::string> export_graph_text(const ExportContent& content,
                                      const std::vector<VariableId>& ids);
/// Those ids: of files, where they are unique, and the smallest free ones.
std::vector<VariableId> choose_export_ids(const ExportContent& content);

/// For the option robot: kUsage, where no robot of this name has poses. `known`: those that have.
Error no_such_robot(const std::string& wanted, const std::string& known);

}  // namespace cairn
