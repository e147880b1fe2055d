// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/supernodes.hpp"

#include <algorithm>

namespace cairn {
namespace {

// Columns first .. end of the next supernode, over rows_below block rows, with `zeros` blocks that
// the factor does not have.
struct Group {
  int first;
  int columns;
  int rows_below;
  double zeros;

  [[nodiscard]] double blocks() const {
    return 0.5 * columns * (columns + 1.0) + static_cast<double>(columns) * rows_below;
  }
};

// Both with the rows of the later one.
Group merged(const Group& child, const Group& parent) {
  const int longer = parent.columns + parent.rows_below - child.rows_below;
  return {child.first, child.columns + parent.columns, parent.rows_below,
          child.zeros + parent.zeros + static_cast<double>(child.columns) * longer};
}

// Fewer, larger steps cost less than the zeros they drag along, within these bounds.
bool worth_merging(const Group& group) {
  const double part = group.zeros / group.blocks();
  if (group.columns <= 3) return part < 0.5;
  if (group.columns <= 12) return part < 0.15;
  return part < 0.05;
}

std::vector<Group> find_groups(std::span<const int> parent, std::span<const int> count) {
  const int n = static_cast<int>(parent.size());
  std::vector<Group> groups;
  for (int j = 0; j < n;) {
    Group group{j, 1, count[j] - 1, 0.0};
    while (parent[j] == j + 1 && count[j + 1] == count[j] - 1) {
      ++j;
      ++group.columns;
      group.rows_below = count[j] - 1;
    }
    ++j;
    // In a postorder a last child ends where its parent begins.
    while (!groups.empty()) {
      const int above = parent[group.first - 1];
      if (above < group.first || above >= group.first + group.columns) break;
      const Group both = merged(groups.back(), group);
      if (!worth_merging(both)) break;
      group = both;
      groups.pop_back();
    }
    groups.push_back(group);
  }
  return groups;
}

}  // namespace

Supernodes Supernodes::find(const BlockGraph& graph, std::span<const int> order,
                            std::span<const int> position, std::span<const int> parent,
                            std::span<const int> count) {
  const std::vector<Group> groups = find_groups(parent, count);
  const std::size_t size = groups.size();
  Supernodes result;
  result.first.resize(size + 1, graph.size());
  result.row_begin.resize(size + 1, 0);
  result.parent.resize(size, -1);
  std::vector<int> supernode_of(order.size());
  for (std::size_t s = 0; s < size; ++s) {
    const Group& group = groups[s];
    result.first[s] = group.first;
    result.row_begin[s + 1] = result.row_begin[s] + group.rows_below;
    std::fill_n(supernode_of.begin() + group.first, group.columns, static_cast<int>(s));
  }
  for (std::size_t s = 0; s < size; ++s) {
    const int above = parent[result.first[s + 1] - 1];
    if (above >= 0) result.parent[s] = supernode_of[above];
  }
  // Each row of the factor is a subtree of the elimination tree: walked for ascending rows, every
  // list comes out in order.
  result.row.resize(static_cast<std::size_t>(result.row_begin.back()));
  std::vector<int> next(result.row_begin.begin(), result.row_begin.end() - 1);
  std::vector<int> mark(size, -1);
  for (int i = 0; i < graph.size(); ++i) {
    const int own = supernode_of[i], block = order[i];
    for (int k = graph.begin[block]; k < graph.begin[block + 1]; ++k) {
      const int j = position[graph.neighbors[k]];
      if (j > i) continue;
      for (int s = supernode_of[j]; s != own && mark[s] != i; s = result.parent[s]) {
        result.row[next[s]++] = i;
        mark[s] = i;
      }
    }
  }
  return result;
}

}  // namespace cairn
