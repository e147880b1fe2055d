// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/graph_format.hpp"

#include <filesystem>

namespace cairn::cli {

GraphFormat output_format(const FormatChoice& to, const std::string& path) {
  if (to) return *to;
  std::filesystem::path name(path);
  if (name.extension() == ".gz" || name.extension() == ".bz2") name.replace_extension();
  if (name.extension() == ".graph") return GraphFormat::kToro;
  if (name.extension() == ".txt") return GraphFormat::kIsam;
  return GraphFormat::kG2o;
}

}  // namespace cairn::cli
