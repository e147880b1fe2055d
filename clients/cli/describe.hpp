// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace cairn::cli {

// What --help, the manual pages and the completion know of a verb.

/// The verbs below `app` that people see.
std::vector<const CLI::App*> visible_verbs(const CLI::App& app);
/// The options (not positionals) that people see.
std::vector<const CLI::Option*> visible_options(const CLI::App& app);
std::vector<const CLI::Option*> positionals(const CLI::App& app);

/// The words an option takes, where it takes one of a list.
std::vector<std::string> choices_of(const CLI::Option& option);
/// "-o" and "--output", short names first.
std::vector<std::string> names_of(const CLI::Option& option);
bool takes_value(const CLI::Option& option);

}  // namespace cairn::cli
