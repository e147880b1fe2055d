// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace cairn::cli {

/// The name of a verb's manual page without section: "cairn", "cairn-optimize".
std::string man_name(const CLI::App& app);
/// The manual page (man macros, section 1) of the program or of one verb, from its options.
std::string man_page(const CLI::App& app);

}  // namespace cairn::cli
