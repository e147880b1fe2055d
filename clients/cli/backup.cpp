// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

struct BackupArguments {
  Target target;
  std::string folder;
  bool quiet = false;
};

struct RestoreArguments {
  std::string backup, folder;
  bool quiet = false;
};

Result<std::string> absolute(const std::string& path) {
  std::error_code error;
  const auto full = std::filesystem::absolute(path, error);
  if (error) return Error{ErrorCode::kUsage, error.message(), path};
  return full.lexically_normal().string();
}

Result<std::string> back_up_folder(const std::string& data, const std::string& folder) {
  if (const auto sound = check_sound(data); !sound) return sound.error();
  const auto journal = Journal::open(data);
  if (!journal) return journal.error();
  if (const auto made = (*journal)->backup(folder); !made) return made.error();
  return "backed up revision " + to_string((*journal)->head().revision) + " to " + folder;
}

Result<std::string> back_up(const BackupArguments& a) {
  const Result<std::string> folder = absolute(a.folder);
  if (!folder) return folder;
  if (a.target.is_folder()) return back_up_folder(a.target.folder, *folder);
  Result<std::string> told = ask(a.target, {"backup", {{"folder", *folder}}});
  if (told && told->ends_with('\n')) told->pop_back();
  return told;
}

Result<std::string> restore(const RestoreArguments& a) {
  if (auto restored = Journal::restore(a.backup, a.folder); !restored) return restored.error();
  const auto journal = open_for_reading(a.folder);
  if (!journal) return journal.error();
  if (const auto sound = (*journal)->verify(); !sound) return sound.error();
  return "restored to " + a.folder + ": revision " + to_string((*journal)->head().revision) +
         "; clients send again what came after the backup";
}

int report(const Result<std::string>& done, bool quiet) {
  if (!done) return fail(done.error());
  Console(false, quiet).say(*done);
  return kDone;
}

}  // namespace

Run add_backup(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<BackupArguments>();
  verb = parent.add_subcommand("backup", "Copy a daemon's journal while it runs");
  verb->footer(
      "Adds a backup to those in DIR; files that did not change are stored once. The daemon of "
      "--domain writes it\n"
      "itself, on its own machine, and goes on serving.\n"
      "Exit codes: 0 done, 2 usage, 3 damaged, 5 no daemon answers, 1 the disk fails.");
  verb->add_option("DIR", a->folder, "folder of backups, made if absent")
      ->required()
      ->default_str("");
  add_target(*verb, a->target);
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a] { return report(back_up(*a), a->quiet); };
}

Run add_restore(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<RestoreArguments>();
  verb = parent.add_subcommand("restore", "Make a data folder from the newest backup");
  verb->footer(
      "The restored journal has a new era, so clients notice, and send again what came after the "
      "backup.\n"
      "Exit codes: 0 done, 2 usage or a folder that is not empty, 3 no sound backup, 1 the disk "
      "fails.");
  verb->add_option("BACKUP", a->backup, "folder of backups")->required()->default_str("");
  verb->add_option("--data", a->folder, "the new data folder: absent or empty")
      ->required()
      ->default_str("")
      ->type_name("DIR");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a] { return report(restore(*a), a->quiet); };
}

}  // namespace cairn::cli
