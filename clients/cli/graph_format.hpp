// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "cairn/io/graph_file.hpp"
#include "clients/cli/choices.hpp"

namespace cairn::cli {

using FormatChoice = std::optional<GraphFormat>;

/// The formats Cairn writes, by the names of --to and --format.
inline const Choices<FormatChoice>& graph_formats() {
  static const Choices<FormatChoice> kFormats{
      {"g2o", GraphFormat::kG2o}, {"toro", GraphFormat::kToro}, {"isam", GraphFormat::kIsam}};
  return kFormats;
}

/// --to where it was given, else by the extension (.g2o, .graph is TORO, .txt is iSAM; .gz and .bz2
/// aside), else g2o.
GraphFormat output_format(const FormatChoice& to, const std::string& path);

}  // namespace cairn::cli
