// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <istream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

enum class GraphFormat { kG2o, kToro, kIsam, kDlr };

/// A graph and what its file said beside it, so that writing loses nothing.
struct GraphDocument {
  Graph graph;
  GraphFormat format = GraphFormat::kG2o;
  /// False for the variables of files with edges only, and for those a file left out: their values
  /// are a chain of edges from the smallest id, not what the file said. One per variable, in slot
  /// order.
  std::vector<bool> has_start;
  std::map<ParameterId, Se2> offsets2;                          ///< PARAMS_SE2OFFSET: T_body_sensor
  std::map<ParameterId, Se3> offsets3;                          ///< PARAMS_SE3OFFSET: T_body_sensor
  std::vector<std::pair<VariableId, VariableId>> equivalences;  ///< EQUIV a b: b was merged into a
  std::vector<std::string> unknown_lines;                       ///< verbatim, without line ends
  std::vector<std::string> warnings;                            ///< "file:line:column: message"
};

struct ReadOptions {
  std::optional<GraphFormat> format{};  ///< otherwise recognized by content
  bool strict = false;                  ///< warnings (unknown tags, ...) are errors
};

/// Reads one graph. `path` is a file (also .gz and .bz2), "-" for standard input, or a folder in
/// the dlr layout.
Result<GraphDocument> read_graph(const std::string& path, const ReadOptions& options = {});
/// Reads from memory; `name` stands for the file in messages. Uncompressed text.
Result<GraphDocument> read_graph_text(std::string_view text, const std::string& name,
                                      const ReadOptions& options = {});
/// Reads several files into one graph: variables are merged by id, and a copy of an edge within
/// 1e-5 of one in another file is dropped.
Result<GraphDocument> read_graphs(const std::vector<std::string>& paths,
                                  const ReadOptions& options = {});

/// The text of the graph in a format. Refused when the format cannot hold it (TORO has no
/// landmarks).
Result<std::string> write_graph_text(const GraphDocument& document, GraphFormat format);
/// Writes to a temporary file beside `path`, then renames; "-" is standard output. Compresses .gz
/// and .bz2.
Result<void> write_graph(const GraphDocument& document, const std::string& path,
                         GraphFormat format);

}  // namespace cairn
