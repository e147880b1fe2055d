// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn::cli {

/// One robot that a graph file stands for.
struct FleetRobot {
  std::string name;  ///< the file's, without its ending
  std::string file;
  std::vector<Transaction> transactions;
};

struct Fleet {
  std::vector<FleetRobot> robots;
  std::vector<std::string> warnings;
};

/// Reads graph files as robots: file by file, a robot owns the vertices of its file. Where files
/// name the vertices of others (64-bit keys, or ids that no two files use), their edges tie the
/// robots together, and one copy of an edge that stands in two files is kept, as
/// read_graphs() does. Files that use the same small ids are unrelated robots. kUsage where two
/// files give the same name; `prefix` stands before every name.
Result<Fleet> read_fleet(const std::vector<std::string>& files, const std::string& prefix);

}  // namespace cairn::cli
