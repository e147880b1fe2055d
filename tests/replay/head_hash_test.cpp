// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/head_hash.hpp"

#include <gtest/gtest.h>

#include "tests/support/transactions.hpp"

namespace cairn {
namespace {

PoseGraph map_of(const std::vector<int>& order) {
  PoseGraph map;
  for (const int i : order) {
    map.nodes.push_back({{{"robot", 1}, static_cast<std::uint64_t>(i)},
                         7,
                         VariableType::kPose2,
                         i,
                         {1.0 * i, 2.0, 0.1},
                         {}});
    map.estimates.push_back({1.5 * i, 2.5, 0.2});
  }
  map.factors.push_back({{{"laser", 5, 1}, 0},
                         7,
                         FactorType{1},
                         FactorKind::kLoop,
                         FactorState::kCommitted,
                         {static_cast<NodeIndex>(order[0] == 0 ? 0 : order.size() - 1),
                          static_cast<NodeIndex>(order[0] == 0 ? order.size() - 1 : 0)},
                         {1.0, 2.0, 3.0}});
  return map;
}

ContentHash hash_of(const PoseGraph& map) {
  HeadHash hash;
  hash.update(map);
  return hash.value();
}

TEST(HeadHash, IsOfTheContentAndNotOfTheOrderOfArrival) {
  const PoseGraph map = map_of({0, 1, 2, 3});
  PoseGraph same = map_of({3, 2, 1, 0});
  same.graph_revision = {77, 1, 12};
  same.factors.edit(0).name.transaction.source = "camera";
  EXPECT_EQ(hash_of(map), hash_of(same));
}

TEST(HeadHash, ChangesWithEveryPartOfTheContent) {
  const PoseGraph map = map_of({0, 1, 2, 3});
  const auto changed = [&](const std::function<void(PoseGraph&)>& change) {
    PoseGraph copy = map;
    change(copy);
    return hash_of(copy);
  };
  std::set<ContentHash> hashes{
      hash_of(map),
      changed([](PoseGraph& m) { m.estimates.edit(2)[1] += 1e-15; }),
      changed([](PoseGraph& m) { m.nodes.edit(2).stamp_ns = 9; }),
      changed([](PoseGraph& m) { m.nodes.edit(2).start[0] = 9; }),
      changed([](PoseGraph& m) { m.nodes.edit(2).id.frame.epoch = 2; }),
      changed([](PoseGraph& m) { m.factors.edit(0).state = FactorState::kDisabled; }),
      changed([](PoseGraph& m) { m.factors.edit(0).kind = FactorKind::kOdometry; }),
      changed([](PoseGraph& m) { m.factors.edit(0).numbers[2] = 4.0; }),
      changed(
          [](PoseGraph& m) { std::swap(m.factors.edit(0).nodes[0], m.factors.edit(0).nodes[1]); }),
  };
  EXPECT_EQ(hashes.size(), 9u);
}

TEST(HeadHash, FollowsAMapAsItGrowsAndChanges) {
  HeadHash hash;
  PoseGraph map = map_of({0, 1, 2, 3});
  hash.grow(map);
  EXPECT_EQ(hash.value(), hash_of(map));
  map.estimates.edit(1)[0] = 7.0;
  map.factors.edit(0).state = FactorState::kRemoved;
  map.nodes.push_back(map.nodes[0]);
  map.nodes.edit(4).id.index = 4;
  map.estimates.push_back({});
  hash.update(map);
  EXPECT_EQ(hash.value(), hash_of(map));
}

}  // namespace
}  // namespace cairn
