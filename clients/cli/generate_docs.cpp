// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "clients/cli/app.hpp"
#include "clients/cli/completion.hpp"
#include "clients/cli/describe.hpp"
#include "clients/cli/man_page.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

Result<void> write_man_pages(const CLI::App& app, const fs::path& folder) {
  for (const CLI::App* verb : visible_verbs(app)) {
    if (Result<void> written = write_man_pages(*verb, folder); !written) return written;
  }
  return write_file((folder / (man_name(app) + ".1")).string(), man_page(app));
}

int run_generate_docs(const CLI::App& app, const std::string& folder) {
  const fs::path manuals = fs::path(folder) / "man1",
                 completions = fs::path(folder) / "bash-completion";
  std::error_code failed;
  fs::create_directories(manuals, failed);
  if (!failed) fs::create_directories(completions, failed);
  if (failed)
    return fail({ErrorCode::kUsage, "cannot create the folder: " + failed.message(), folder});
  Result<void> written = write_man_pages(app, manuals);
  if (written) written = write_file((completions / "cairn").string(), bash_completion(app));
  return written ? kDone : fail(written.error());
}

}  // namespace

Run add_generate_docs(CLI::App& parent, CLI::App*& verb) {
  auto folder = std::make_shared<std::string>();
  verb = parent.add_subcommand("generate-docs", "write manual pages and bash completion");
  verb->group("");  // for the build, not for people
  verb->add_option("DIR", *folder, "folder to write to")->required();
  return [folder, &parent] { return run_generate_docs(parent, *folder); };
}

}  // namespace cairn::cli
