// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/man_page.hpp"

#include <cctype>
#include <sstream>
#include <utility>

#include "clients/cli/app.hpp"
#include "clients/cli/describe.hpp"

namespace cairn::cli {
namespace {

constexpr const char* kDate = "2026-11-22";  // of this version's command line

// Text that roff shows as it is: hyphens that can be copied, no accidental requests.
std::string escaped(const std::string& text) {
  std::string roff;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      roff += c;
    }
    line_start = c == '\n';
  }
  return roff;
}

// The text in lines that are short enough to be edited and compared.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kLineLength = 70;
  std::istringstream words(text);
  std::string lines, line, word;
  while (words >> word) {
    if (!line.empty() && line.size() + word.size() > kLineLength)
      lines += std::exchange(line, {}) + "\n";
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string full_name(const CLI::App& app) {
  return app.get_parent() ? full_name(*app.get_parent()) + " " + app.get_name() : app.get_name();
}

std::string synopsis(const CLI::App& app) {
  std::string text = ".B " + escaped(full_name(app)) + "\n";
  for (const CLI::Option* option : positionals(app)) {
    const std::string name =
        option->get_single_name() + (option->get_expected_max() > 1 ? "..." : "");
    text += ".I " + escaped(option->get_required() ? name : "[" + name + "]") + "\n";
  }
  if (!visible_verbs(app).empty()) text += ".I VERB\n";
  return text + "[options]\n";
}

std::string option_entry(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : names_of(option)) names += (names.empty() ? "" : ", ") + name;
  if (option.get_positional()) names = option.get_single_name();
  std::string entry = ".TP\n.B " + escaped(names) + "\n";
  const bool has_value = takes_value(option) && !option.get_positional();
  if (has_value) entry.insert(entry.size() - 1, " \\fI" + escaped(option.get_type_name()) + "\\fR");
  std::string description = option.get_description();
  if (takes_value(option) && !option.get_default_str().empty()) {
    description += "; default " + option.get_default_str();
  }
  return entry + escaped(wrapped(description + ".")) + "\n";
}

std::string verb_entry(const CLI::App& verb) {
  return ".TP\n.B " + escaped(verb.get_name()) + "\n" + escaped(verb.get_description()) + ".\n";
}

std::string see_also(const CLI::App& app) {
  if (app.get_parent())
    return ".SH SEE ALSO\n.BR " + escaped(man_name(*app.get_parent())) + " (1)\n";
  std::string text;
  for (const CLI::App* verb : visible_verbs(app)) {
    text +=
        (text.empty() ? ".SH SEE ALSO\n" : ",\n") + (".BR " + escaped(man_name(*verb)) + " (1)");
  }
  return text + "\n";
}

}  // namespace

std::string man_name(const CLI::App& app) {
  return app.get_parent() ? man_name(*app.get_parent()) + "-" + app.get_name() : app.get_name();
}

std::string man_page(const CLI::App& app) {
  std::string page = ".TH " + escaped(upper(man_name(app))) + " 1 " + kDate + " \"cairn " +
                     kVersion + "\" \"Cairn manual\"\n";
  page += ".SH NAME\n" + escaped(man_name(app)) + " \\- " + escaped(app.get_description()) + "\n";
  page += ".SH SYNOPSIS\n" + synopsis(app);
  if (!visible_verbs(app).empty()) page += ".SH VERBS\n";
  for (const CLI::App* verb : visible_verbs(app)) page += verb_entry(*verb);
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : positionals(app)) page += option_entry(*option);
  for (const CLI::Option* option : visible_options(app)) page += option_entry(*option);
  if (!app.get_footer().empty()) page += ".SH NOTES\n" + escaped(wrapped(app.get_footer())) + "\n";
  return page + see_also(app);
}

}  // namespace cairn::cli
