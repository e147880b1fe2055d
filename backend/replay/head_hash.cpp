// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/head_hash.hpp"

#include <bit>
#include <cstring>

#include "cairn/core/bytes.hpp"

namespace cairn {
namespace {

void write(ByteWriter& to, const NodeId& node) {
  to.text(node.frame.robot);
  to.integer(node.frame.epoch);
  to.integer(node.index);
}

template <class Numbers>
void write_all(ByteWriter& to, const Numbers& numbers) {
  to.count(numbers.size());
  for (const double number : numbers) to.real(number);
}

std::array<std::uint64_t, 4> words(const ContentHash& hash) {
  ByteReader from({reinterpret_cast<const char*>(hash.data()), hash.size()});
  std::array<std::uint64_t, 4> words;
  for (std::uint64_t& word : words) word = from.integer<std::uint64_t>();
  return words;
}

}  // namespace

void HeadHash::add(Sum& sum, const Sum& term) {
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const std::uint64_t with_carry = sum[i] + carry;
    carry = with_carry < carry;
    sum[i] = with_carry + term[i];
    carry += sum[i] < with_carry;
  }
}

void HeadHash::subtract(Sum& sum, const Sum& term) {
  // Two's complement: -term = ~term + 1.
  Sum negative;
  for (std::size_t i = 0; i < term.size(); ++i) negative[i] = ~term[i];
  add(sum, negative);
  add(sum, {1, 0, 0, 0});
}

HeadHash::Sum HeadHash::hash_node(const PoseGraph& map, NodeIndex node) {
  const StoredNode& stored = map.nodes[node];
  std::string bytes;
  ByteWriter to(bytes);
  write(to, stored.id);
  to.integer(static_cast<std::uint8_t>(stored.type));
  to.integer(stored.stamp_ns);
  write_all(to, stored.start);
  write_all(to, stored.odometry);
  write_all(to, map.estimates[node]);
  return words(content_hash(bytes));
}

HeadHash::Sum HeadHash::hash_factor(const PoseGraph& map, std::size_t factor) {
  const StoredFactor& stored = map.factors[factor];
  std::string bytes;
  ByteWriter to(bytes);
  to.integer(static_cast<std::uint16_t>(stored.type));
  to.integer(static_cast<std::uint8_t>(stored.kind));
  to.integer(static_cast<std::uint8_t>(stored.state));
  to.count(stored.nodes.size());
  for (const NodeIndex node : stored.nodes) write(to, map.nodes[node].id);
  write_all(to, stored.numbers);
  return words(content_hash(bytes));
}

void HeadHash::grow(const PoseGraph& map) {
  for (auto node = static_cast<NodeIndex>(estimates_.size()); node < map.nodes.size(); ++node) {
    estimates_.push_back(map.estimates[node]);
    node_terms_.push_back(hash_node(map, node));
    add(nodes_, node_terms_.back());
  }
  for (std::size_t factor = states_.size(); factor < map.factors.size(); ++factor) {
    states_.push_back(map.factors[factor].state);
    add(factors_, hash_factor(map, factor));
  }
}

void HeadHash::update(const PoseGraph& map) {
  for (NodeIndex node = 0; node < estimates_.size(); ++node) {
    const Estimate& now = map.estimates[node];
    if (std::memcmp(&estimates_[node], &now, sizeof now) == 0) continue;
    estimates_[node] = now;
    subtract(nodes_, node_terms_[node]);
    node_terms_[node] = hash_node(map, node);
    add(nodes_, node_terms_[node]);
  }
  for (std::size_t factor = 0; factor < states_.size(); ++factor) {
    if (states_[factor] == map.factors[factor].state) continue;
    PoseGraph before = map;  // shares memory with the map
    before.factors.edit(factor).state = states_[factor];
    subtract(factors_, hash_factor(before, factor));
    add(factors_, hash_factor(map, factor));
    states_[factor] = map.factors[factor].state;
  }
  grow(map);
}

ContentHash HeadHash::value() const {
  std::string bytes;
  ByteWriter to(bytes);
  to.integer(static_cast<std::uint64_t>(estimates_.size()));
  for (const std::uint64_t word : nodes_) to.integer(word);
  to.integer(static_cast<std::uint64_t>(states_.size()));
  for (const std::uint64_t word : factors_) to.integer(word);
  return content_hash(bytes);
}

}  // namespace cairn
