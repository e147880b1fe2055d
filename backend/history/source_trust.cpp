// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/source_trust.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/innovation.hpp"
#include "cairn/solver/loop_groups.hpp"

namespace cairn {
namespace {

constexpr double kLeastRedundancy = 10.0;
constexpr std::size_t kMostRows = 256;
constexpr double kHonest = 1.5;  // times more or less

using Key = std::tuple<std::string, std::string, FactorKind>;

struct Checked {
  std::vector<double> ratios;
  double redundancy = 0.0;
};

Graph graph_at_estimates(PoseGraph map, const CanonicalOrder& order) {
  for (const NodeIndex node : order.nodes) {
    const auto* numbers = map.estimates[node].data();
    std::vector<double>& start = map.nodes.edit(node).start;
    std::copy_n(numbers, start.size(), start.begin());
  }
  return canonical_graph(map, order);
}

std::map<Key, Checked> check_all(const PoseGraph& map) {
  std::map<Key, Checked> all;
  const CanonicalOrder order(map,
                             [&](std::uint32_t f) { return takes_part(map.factors[f].state); });
  const Graph graph = graph_at_estimates(map, order);
  const auto marginals = Marginals::compute(graph, optimizer_options({}));
  for (std::size_t i = 0; marginals && i < order.factors.size(); ++i) {
    if (order.factors[i] >= map.first_unsolved_factor) continue;
    const auto innovation = innovation_inside(graph, graph.factors()[i], *marginals);
    if (!innovation || innovation->dimension == 0) continue;
    const StoredFactor& factor = map.factors[order.factors[i]];
    std::set<std::string> robots;
    for (const NodeIndex node : factor.nodes) robots.insert(map.nodes[node].id.frame.robot);
    for (const std::string& robot : robots) {
      Checked& checked = all[{factor.name.transaction.source, robot, factor.kind}];
      checked.ratios.push_back(innovation->chi2 / median_chi2(innovation->dimension));
      checked.redundancy += innovation->redundancy;
    }
  }
  return all;
}

}  // namespace

std::vector<SourceTrust> measure_trust(const PoseGraph& map) {
  std::vector<SourceTrust> rows;
  for (auto& [key, checked] : check_all(map)) {
    if (checked.redundancy < kLeastRedundancy) continue;
    const auto& [source, robot, kind] = key;
    const std::size_t count = checked.ratios.size();
    rows.push_back({source, robot, kind, count, checked.redundancy,
                    std::sqrt(median(std::move(checked.ratios)))});
  }
  if (rows.size() <= kMostRows) return rows;
  std::stable_sort(rows.begin(), rows.end(), [](const SourceTrust& a, const SourceTrust& b) {
    return a.redundancy > b.redundancy;
  });
  rows.resize(kMostRows);
  std::sort(rows.begin(), rows.end(), [](const SourceTrust& a, const SourceTrust& b) {
    return std::tie(a.source, a.robot, a.kind) < std::tie(b.source, b.robot, b.kind);
  });
  return rows;
}

std::string describe(const SourceTrust& trust) {
  const double factor = trust.sigma_factor;
  if (factor <= kHonest && factor >= 1.0 / kHonest) return "honest";
  char text[64];
  std::snprintf(text, sizeof text, "%.2gx %s-confident", factor > 1.0 ? factor : 1.0 / factor,
                factor > 1.0 ? "over" : "under");
  return text;
}

}  // namespace cairn
