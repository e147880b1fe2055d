// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/elimination.hpp"

#include <amd.h>
#include <cholmod.h>

#include <numeric>

#include "cairn/core/check.hpp"

namespace cairn {
namespace {

// Block operations per block from which on a second ordering costs less than it can save.
constexpr double kTryNestedDissection = 1000.0;

std::vector<int> inverse_permutation(std::span<const int> order) {
  std::vector<int> position(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) position[order[i]] = static_cast<int>(i);
  return position;
}

// Liu 1990: elimination tree with path compression.
std::vector<int> elimination_tree(const BlockGraph& graph, std::span<const int> order,
                                  std::span<const int> position) {
  const int n = graph.size();
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int i = 0; i < n; ++i) {
    const int block = order[i];
    for (int k = graph.begin[block]; k < graph.begin[block + 1]; ++k) {
      for (int j = position[graph.neighbors[k]]; j != -1 && j < i;) {
        const int next = ancestor[j];
        ancestor[j] = i;
        if (next == -1) parent[j] = i;
        j = next;
      }
    }
  }
  return parent;
}

// Depth-first order of a forest, children in ascending order.
std::vector<int> postorder(std::span<const int> parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> first_child(n, -1), next_sibling(n, -1), order, stack;
  for (int i = n - 1; i >= 0; --i) {
    if (parent[i] < 0) continue;
    next_sibling[i] = first_child[parent[i]];
    first_child[parent[i]] = i;
  }
  order.reserve(n);
  for (int root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int node = stack.back();
      if (first_child[node] >= 0) {
        stack.push_back(first_child[node]);
        first_child[node] = next_sibling[first_child[node]];
      } else {
        order.push_back(node);
        stack.pop_back();
      }
    }
  }
  return order;
}

// Each row of the factor is a subtree of the elimination tree: walk it once, marking.
std::vector<int> column_counts(const BlockGraph& graph, std::span<const int> order,
                               std::span<const int> position, std::span<const int> parent) {
  const int n = graph.size();
  std::vector<int> count(n, 1), mark(n, -1);
  for (int i = 0; i < n; ++i) {
    mark[i] = i;
    const int block = order[i];
    for (int k = graph.begin[block]; k < graph.begin[block + 1]; ++k) {
      for (int j = position[graph.neighbors[k]]; j < i && mark[j] != i; j = parent[j]) {
        ++count[j];
        mark[j] = i;
      }
    }
  }
  return count;
}

std::vector<int> amd_order_of(const BlockGraph& graph) {
  std::vector<int> order(graph.size());
  if (graph.neighbors.empty()) {  // AMD takes no null arrays
    std::iota(order.begin(), order.end(), 0);
    return order;
  }
  const int status = amd_order(graph.size(), graph.begin.data(), graph.neighbors.data(),
                               order.data(), nullptr, nullptr);
  CAIRN_CHECK(status == AMD_OK, "amd_order failed");
  return order;
}

// Empty where METIS gives up.
std::vector<int> metis_order_of(const BlockGraph& graph) {
  cholmod_common common;
  cholmod_start(&common);
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(graph.size());
  matrix.nzmax = graph.neighbors.size();
  matrix.p = const_cast<int*>(graph.begin.data());
  matrix.i = const_cast<int*>(graph.neighbors.data());
  matrix.stype = 1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_PATTERN;
  matrix.sorted = matrix.packed = 1;
  std::vector<int> order(graph.size());
  const bool ok = cholmod_metis(&matrix, nullptr, 0, 0, order.data(), &common) != 0;
  cholmod_finish(&common);
  if (!ok) order.clear();
  return order;
}

}  // namespace

double Elimination::block_operations() const {
  double operations = 0.0;
  for (const int c : count) operations += static_cast<double>(c) * c;
  return operations;
}

Elimination analyze_elimination(const BlockGraph& graph, std::span<const int> order,
                                std::string_view method) {
  const std::vector<int> unordered = inverse_permutation(order);
  const std::vector<int> post = postorder(elimination_tree(graph, order, unordered));
  std::vector<int> ordered(order.size());
  for (std::size_t i = 0; i < post.size(); ++i) ordered[i] = order[post[i]];
  Elimination elimination;
  elimination.position = inverse_permutation(ordered);
  elimination.parent = elimination_tree(graph, ordered, elimination.position);
  elimination.count = column_counts(graph, ordered, elimination.position, elimination.parent);
  elimination.supernodes =
      Supernodes::find(graph, ordered, elimination.position, elimination.parent, elimination.count);
  elimination.method = method;
  return elimination;
}

Elimination find_elimination(const BlockGraph& graph) {
  Elimination best = analyze_elimination(graph, amd_order_of(graph), "amd");
  if (best.block_operations() <= kTryNestedDissection * graph.size()) return best;
  const std::vector<int> order = metis_order_of(graph);
  if (order.empty()) return best;
  Elimination nested = analyze_elimination(graph, order, "metis");
  return nested.block_operations() < best.block_operations() ? nested : best;
}

}  // namespace cairn
