// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/io/graph_file.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/graph_format.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct ConvertArguments {
  std::vector<std::string> paths;  ///< one or more inputs, then the output
  FormatChoice format, to;
  bool strict = false, quiet = false;
};

constexpr const char* kConvertFooter =
    "IN may be '-' (standard input), compressed (.gz, .bz2), or a folder in the dlr layout; "
    "several "
    "are merged by id.\n"
    "OUT may be '-' (standard output); .gz and .bz2 are compressed.\n"
    "What the output format cannot hold is refused; iSAM files hold no estimates, only "
    "measurements.\n"
    "Exit codes: 0 done, 2 usage, 3 bad input (nothing is written), 1 internal error.";

// What goes without an error but not without a word.
void warn_of_loss(const GraphDocument& document, GraphFormat to) {
  const auto estimates = std::count(document.has_start.begin(), document.has_start.end(), true);
  if (to != GraphFormat::kIsam || estimates == 0) return;
  Console::warn("warning: iSAM files hold no estimates; those of " + std::to_string(estimates) +
                " vertices are left out");
}

int run_convert(const ConvertArguments& a) {
  if (a.paths.size() < 2) {
    return fail({ErrorCode::kUsage, "name the input and the output: cairn convert IN OUT"});
  }
  const std::string& out = a.paths.back();
  if (Result<void> writable = check_outputs({out}); !writable) return fail(writable.error());
  const std::vector<std::string> inputs(a.paths.begin(), a.paths.end() - 1);
  const auto document = read_graphs(inputs, {.format = a.format, .strict = a.strict});
  if (!document) return fail(document.error());
  for (const std::string& warning : document->warnings) Console::warn("warning: " + warning);
  const GraphFormat to = output_format(a.to, out);
  if (Result<void> written = write_graph(*document, out, to); !written)
    return fail(written.error());
  warn_of_loss(*document, to);
  const Console console(out == "-", a.quiet);
  console.say("wrote " + (out == "-" ? "standard output" : out) + ": " +
              std::to_string(document->graph.variables().size()) + " vertices, " +
              std::to_string(document->graph.factor_count()) + " edges");
  return kDone;
}

}  // namespace

Run add_convert(CLI::App& parent, CLI::App*& verb) {
  auto arguments = std::make_shared<ConvertArguments>();
  verb = parent.add_subcommand("convert", "Write a graph in another format");
  verb->footer(kConvertFooter);
  verb->add_option("IN OUT", arguments->paths, "the graph files to read, then the one to write")
      ->required()
      ->default_str("")
      ->type_name("FILE");
  add_choice(*verb, "--format", arguments->format, graph_formats(),
             "format of the input, where its content does not tell");
  add_choice(*verb, "--to", arguments->to, graph_formats(),
             "format of the output; else by extension, else g2o");
  verb->add_flag("--strict", arguments->strict, "warnings (unknown tags, ...) are errors");
  verb->add_flag("-q,--quiet", arguments->quiet, "say nothing but warnings and errors");
  return [arguments] { return run_convert(*arguments); };
}

}  // namespace cairn::cli
