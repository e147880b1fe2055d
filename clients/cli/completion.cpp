// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/completion.hpp"

#include "clients/cli/describe.hpp"

namespace cairn::cli {
namespace {

constexpr const char* kHead = R"(# bash completion for cairn, generated from its --help
_cairn() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} verb= words= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$verb ${COMP_WORDS[i]}" in
)";
constexpr const char* kOptionWords = R"(    esac
  done
  case "$verb $previous" in
)";
constexpr const char* kVerbWords = R"(  esac
  case "$verb" in
)";
constexpr const char* kTail = R"(  esac
  [[ -n $words ]] && COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _cairn cairn
)";

std::string with_spaces(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// The three tables of one verb and of those below it; `path` is " eval ate".
struct Tables {
  std::string verbs, option_words, verb_words;

  void add(const CLI::App& app, const std::string& path) {
    std::vector<std::string> options, below;
    for (const CLI::Option* option : visible_options(app)) {
      const std::vector<std::string> names = names_of(*option);
      options.insert(options.end(), names.begin(), names.end());
      add_values(*option, names, path);
    }
    for (const CLI::Option* positional : positionals(app)) {
      const std::vector<std::string> words = choices_of(*positional);
      below.insert(below.end(), words.begin(), words.end());
    }
    for (const CLI::App* verb : visible_verbs(app)) {
      below.push_back(verb->get_name());
      verbs += "      \"" + path + " " + verb->get_name() + "\") verb=\"" + path + " " +
               verb->get_name() + "\" ;;\n";
      add(*verb, path + " " + verb->get_name());
    }
    verb_words += "    \"" + path + "\") [[ $word == -* ]] && words=\"" + with_spaces(options) +
                  "\" || words=\"" + with_spaces(below) + "\" ;;\n";
  }

  void add_values(const CLI::Option& option, const std::vector<std::string>& names,
                  const std::string& path) {
    const std::vector<std::string> choices = choices_of(option);
    if (!takes_value(option)) return;
    std::string patterns;
    for (const std::string& name : names)
      patterns += (patterns.empty() ? "\"" : " | \"") + path + " " + name + "\"";
    // Options with a free value complete file names, which is what bash does with no answer.
    option_words +=
        "    " + patterns + ") COMPREPLY=(" +
        (choices.empty() ? "" : "$(compgen -W \"" + with_spaces(choices) + "\" -- \"$word\")") +
        "); return ;;\n";
  }
};

}  // namespace

std::string bash_completion(const CLI::App& app) {
  Tables tables;
  tables.add(app, "");
  return kHead + tables.verbs + kOptionWords + tables.option_words + kVerbWords +
         tables.verb_words + kTail;
}

}  // namespace cairn::cli
