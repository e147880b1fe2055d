// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "cairn/core/bytes.hpp"
#include "cairn/graph/node_id.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// The longest name of a robot or a source, bytes.
inline constexpr std::size_t kLongestName = 64;

/// Nodes repeat their robot: the odometry frames stand once, before the nodes, in the order in
/// which nodes first use them. A node is then the number of its frame (u32) and its index (u64).
class FrameTable {
 public:
  /// The number of the node's frame; a new frame is added.
  std::uint32_t add(const OdometryFrame& frame);
  void write(ByteWriter& to) const;
  void write_node(ByteWriter& to, const NodeId& node);

  static FrameTable read(ByteReader& from);
  NodeId read_node(ByteReader& from);
  /// A problem for `from` where a frame has not been used.
  void require_all_used(ByteReader& from) const;

 private:
  std::vector<OdometryFrame> frames_;
  std::size_t used_ = 0;  // reading: frames 0 .. used_-1 have occurred
};

void write_numbers(ByteWriter& to, const std::vector<double>& numbers);
std::vector<double> read_numbers(ByteReader& from);
/// 1 to kLongestName bytes, else a problem.
std::string read_name(ByteReader& from);
void write_key(ByteWriter& to, const TransactionKey& key);
TransactionKey read_key(ByteReader& from);
void write_factor_name(ByteWriter& to, const FactorName& name);
FactorName read_factor_name(ByteReader& from);

}  // namespace cairn
