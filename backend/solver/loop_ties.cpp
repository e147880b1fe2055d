// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_ties.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace cairn {
namespace {

// Whether a factor says where in the map its first variable is.
bool places(const FactorBatch& batch, const Variable& variable) {
  const bool in_plane =
      variable.type == VariableType::kPose2 || variable.type == VariableType::kPoint2;
  return batch.is_absolute() && batch.residual_dimension() >= (in_plane ? 2 : 3);
}

DisjointSets parts_without(const std::vector<LoopTies::Loop>& loops, const Graph& graph) {
  std::vector<bool> is_loop(graph.factor_count());
  for (const LoopTies::Loop& loop : loops) is_loop[loop.factor] = true;
  const std::size_t map = graph.variables().size();
  DisjointSets parts(map + 1);
  for (std::size_t f = 0; f < graph.factor_count(); ++f) {
    if (is_loop[f]) continue;
    const FactorRef factor = graph.factors()[f];
    const std::vector<VariableSlot> slots = graph.slots_of(factor);
    for (const VariableSlot slot : slots) parts.join(slots.front(), slot);
    if (places(*graph.batches()[factor.batch], graph.variables()[slots.front()]))
      parts.join(slots.front(), map);
  }
  for (VariableSlot slot = 0; slot < map; ++slot)
    if (graph.variables()[slot].fixed) parts.join(slot, map);
  return parts;
}

std::vector<std::uint32_t> robots_of(const Graph& graph) {
  std::vector<std::uint32_t> robots;
  for (const Variable& variable : graph.variables())
    robots.push_back(static_cast<std::uint32_t>(variable.id.value >> 56));
  return robots;
}

}  // namespace

LoopTies::LoopTies(const Graph& graph, std::vector<Loop> loops, std::size_t least,
                   std::vector<std::uint32_t> frames)
    : frames_(frames.empty() ? robots_of(graph) : std::move(frames)),
      loops_(std::move(loops)),
      least_(least),
      parts_(parts_without(loops_, graph)),
      joined_(parts_) {}

std::pair<std::size_t, std::size_t> LoopTies::parts_of(const Loop& loop) {
  return std::minmax({joined_.root(loop.a), joined_.root(loop.b)});
}

bool LoopTies::joined(std::size_t loop) {
  const auto [a, b] = parts_of(loops_[loop]);
  return a == b;
}

std::size_t LoopTies::distinct_places(const std::vector<std::size_t>& loops) const {
  std::set<VariableSlot> first, second;
  for (const std::size_t i : loops) {
    first.insert(loops_[i].a);
    second.insert(loops_[i].b);
  }
  return std::min(first.size(), second.size());
}

std::size_t LoopTies::places_like(std::size_t loop, const std::vector<bool>& among) {
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < loops_.size(); ++i)
    if (among[i] && parts_of(loops_[i]) == parts_of(loops_[loop])) alike.push_back(i);
  return distinct_places(alike);
}

bool LoopTies::enough(const std::vector<std::size_t>& loops) const {
  return distinct_places(loops) >= least_ ||
         std::any_of(loops.begin(), loops.end(), [this](std::size_t i) {
           return frames_[loops_[i].a] == frames_[loops_[i].b];
         });
}

void LoopTies::join(std::vector<bool>& in) {
  joined_ = parts_;
  while (true) {
    std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> ties;
    for (std::size_t i = 0; i < loops_.size(); ++i)
      if (in[i] && !joined(i)) ties[parts_of(loops_[i])].push_back(i);
    auto strongest = ties.end();
    std::size_t most = 0;
    for (auto tie = ties.begin(); tie != ties.end(); ++tie) {
      const std::size_t places = distinct_places(tie->second);
      if (places <= most || !enough(tie->second)) continue;
      most = places;
      strongest = tie;
    }
    if (strongest == ties.end()) {
      for (const auto& [parts, few] : ties)
        for (const std::size_t i : few) in[i] = false;
      return;
    }
    joined_.join(strongest->first.first, strongest->first.second);
  }
}

}  // namespace cairn
