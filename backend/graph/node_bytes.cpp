// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/node_bytes.hpp"

#include <algorithm>

namespace cairn {

std::uint32_t FrameTable::add(const OdometryFrame& frame) {
  // From the back: a node mostly has the frame of the node before it, and there are few frames.
  const auto found = std::find(frames_.rbegin(), frames_.rend(), frame);
  if (found != frames_.rend()) return static_cast<std::uint32_t>(frames_.rend() - found - 1);
  frames_.push_back(frame);
  return static_cast<std::uint32_t>(frames_.size() - 1);
}

void FrameTable::write(ByteWriter& to) const {
  to.count(frames_.size());
  for (const OdometryFrame& frame : frames_) {
    to.text(frame.robot);
    to.integer(frame.epoch);
  }
}

void FrameTable::write_node(ByteWriter& to, const NodeId& node) {
  to.integer(add(node.frame));
  to.integer(node.index);
}

FrameTable FrameTable::read(ByteReader& from) {
  FrameTable table;
  const std::size_t count = from.count(13);
  table.frames_.reserve(count);
  for (std::size_t i = 0; i < count && from.ok(); ++i) {
    std::string robot = read_name(from);
    table.frames_.push_back({std::move(robot), from.integer<std::uint64_t>()});
  }
  std::vector<OdometryFrame> sorted = table.frames_;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    from.fail("names an odometry frame twice");
  return table;
}

NodeId FrameTable::read_node(ByteReader& from) {
  const auto frame = from.integer<std::uint32_t>();
  const auto index = from.integer<std::uint64_t>();
  if (!from.ok()) return {};
  if (frame >= frames_.size() || frame > used_) {
    from.fail("uses an odometry frame that is not next in its table");
    return {};
  }
  if (frame == used_) ++used_;
  return {frames_[frame], index};
}

void FrameTable::require_all_used(ByteReader& from) const {
  if (used_ != frames_.size()) from.fail("names an odometry frame that no node uses");
}

void write_numbers(ByteWriter& to, const std::vector<double>& numbers) {
  to.count(numbers.size());
  for (const double number : numbers) to.real(number);
}

std::vector<double> read_numbers(ByteReader& from) {
  std::vector<double> numbers(from.count(sizeof(double)));
  for (double& number : numbers) number = from.real();
  return numbers;
}

std::string read_name(ByteReader& from) {
  const std::string_view name = from.text();
  if (from.ok() && (name.empty() || name.size() > kLongestName))
    from.fail("has a name that is not 1 to 64 bytes long");
  return std::string(name);
}

void write_key(ByteWriter& to, const TransactionKey& key) {
  to.text(key.source);
  to.integer(key.epoch);
  to.integer(key.sequence);
}

TransactionKey read_key(ByteReader& from) {
  TransactionKey key;
  key.source = read_name(from);
  key.epoch = from.integer<std::uint64_t>();
  key.sequence = from.integer<std::uint64_t>();
  return key;
}

void write_factor_name(ByteWriter& to, const FactorName& name) {
  write_key(to, name.transaction);
  to.integer(name.index);
}

FactorName read_factor_name(ByteReader& from) {
  FactorName name;
  name.transaction = read_key(from);
  name.index = from.integer<std::uint32_t>();
  return name;
}

}  // namespace cairn
