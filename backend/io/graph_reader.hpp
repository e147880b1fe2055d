// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cairn/io/graph_file.hpp"

namespace cairn {

/// A text in memory and what messages call it.
struct NamedText {
  std::string name;
  std::string_view text;
};

/// Reads one graph from texts in g2o, TORO or iSAM format, each recognized by content. Vertices and
/// edges of all texts are merged by id.
Result<GraphDocument> read_graph_texts(const std::vector<NamedText>& texts,
                                       const ReadOptions& options);

/// The three files of a dlr folder.
struct DlrTexts {
  NamedText vertices;  ///< `id, offset into the state, dimension` per line
  NamedText state;     ///< one number per line
  NamedText edges;     ///< `P, from, to, ...` and `L, from, to, ...`
};

/// Reads a graph in the dlr layout (backend/io/README.md).
Result<GraphDocument> read_dlr_texts(const DlrTexts& texts);

}  // namespace cairn
