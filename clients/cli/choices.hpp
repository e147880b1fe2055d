// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace cairn::cli {

/// A range check that does not clutter the help.
inline CLI::Validator in_range(int lowest, int highest) {
  CLI::Validator range = CLI::Range(lowest, highest);
  return range.description("");
}

/// The words an option takes and what they mean. Help, completion and errors list them.
template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

template <class T>
std::string join_names(const Choices<T>& choices, const std::string& separator) {
  std::string names;
  for (const auto& [name, value] : choices) names += (names.empty() ? "" : separator) + name;
  return names;
}

/// Adds an option that takes one of `choices` into `target`. The default shown is the choice that
/// `target` holds already; a `target` that holds none of them (an empty optional) has no default.
template <class T>
CLI::Option* add_choice(CLI::App& app, const std::string& name, T& target,
                        const Choices<T>& choices, const std::string& help) {
  const auto assign = [&target, choices, name](const std::string& word) {
    for (const auto& [known, value] : choices) {
      if (known == word) return void(target = value);
    }
    throw CLI::ValidationError(name, "'" + word + "' is not one of " + join_names(choices, ", "));
  };
  CLI::Option* option = app.add_option_function<std::string>(name, assign, help);
  for (const auto& [known, value] : choices) {
    if (value == target) option->default_str(known);
  }
  return option->type_name("{" + join_names(choices, "|") + "}");
}

}  // namespace cairn::cli
