// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/history/record_json.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/verb.hpp"
#include "server/reexecution.hpp"

namespace cairn::cli {
namespace {

struct VerifyArguments {
  std::string folder, hashes;
  std::optional<std::uint64_t> at;
  bool json = false, quiet = false;
};

constexpr const char* kVerifyFooter =
    "Checks every block of the store and the chain of records, then executes the journal again: "
    "every decision\n"
    "is made anew, every solve is solved anew, and both must come out as recorded, bit for bit. "
    "Solves made\n"
    "on a machine whose libraries round otherwise are `not bit-comparable` and compared to 1e-9. "
    "Changes nothing\n"
    "in the folder, which no daemon may serve meanwhile.\n"
    "The hash of the head stands for nodes, estimates, factors and their states, not for keys and "
    "numbers: two\n"
    "journals can be compared at every revision. --hashes: CSV `number,era,kind,head hash,chain "
    "hash`.\n"
    "Exit codes: 0 sound, 2 usage, 3 damaged or different, 1 internal error.";

struct Verified {
  JournalHead head;
  std::optional<std::string> cut_tail;
  Reexecuted executed;
  std::optional<ContentHash> hash_at;
};

Result<Verified> verify(const VerifyArguments& a, const Console& console) {
  JournalOptions options;
  options.read_only = true;
  const auto journal = Journal::open(a.folder, options);
  if (!journal) return journal.error();
  Verified verified{(*journal)->head(), (*journal)->open_report().cut_tail, {}, {}};
  const std::uint64_t last = verified.head.revision.number;
  if (a.at && (*a.at == 0 || *a.at > last)) {
    return Error{ErrorCode::kUsage, "--at " + std::to_string(*a.at) +
                                        ": the journal has records 1 to " + std::to_string(last)};
  }
  if (Result<void> sound = (*journal)->verify(); !sound) return sound.error();
  std::string hashes;
  const auto on_record = [&](const Record& record, const ContentHash& head) {
    if (record.number % 1000 == 0)
      console.show_progress("executed " + std::to_string(record.number) + " of " +
                            std::to_string(last) + " records again");
    if (a.at == record.number) verified.hash_at = head;
    if (a.hashes.empty()) return;
    hashes += std::to_string(record.number) + ',' + std::to_string(record.era) + ',' +
              kind_of(record) + ',' + to_string(head) + ',' + to_string(record.chain) + '\n';
  };
  Result<Reexecuted> executed = Reexecution(**journal).run(on_record);
  console.clear_progress();
  if (!executed) {
    const Error& error = executed.error();
    return Error{error.code, error.message, a.folder + ": " + error.place};
  }
  verified.executed = std::move(*executed);
  if (!a.hashes.empty()) {
    if (Result<void> written = write_file(a.hashes, hashes); !written) return written.error();
  }
  return verified;
}

void say_text(const Verified& v, const VerifyArguments& a, const Console& console) {
  const Reexecuted& e = v.executed;
  if (v.cut_tail) {
    Console::warn("warning: the last write never finished, and was never acknowledged: " +
                  *v.cut_tail + "; it is left out");
  }
  console.say("revision " + to_string(v.head.revision) + ": every block and the chain are sound");
  console.say(std::to_string(e.records) + " records: " + std::to_string(e.accepted) +
              " transactions accepted, " + std::to_string(e.refused) + " refused, " +
              std::to_string(e.commands) + " commands, " + std::to_string(e.verdicts) +
              " verdicts, decided again alike");
  console.say(std::to_string(e.solves) + " solves solved again with the same bits");
  if (e.solves_compared > 0) {
    char largest[32];
    std::snprintf(largest, sizeof largest, "%.2g", e.largest_difference);
    console.say(std::to_string(e.solves_compared) + " solves not bit-comparable (made with \"" +
                *e.other_settings + "\", here is \"" + SolveSettings::here().to_string() +
                "\"): equal to 1e-9, largest difference " + largest);
  }
  if (e.solves_skipped > 0) {
    Console::warn("warning: " + std::to_string(e.solves_skipped) +
                  " solves were made by methods that this version does not have; only their "
                  "hashes were checked");
  }
  for (const std::string& gap : e.gaps)
    Console::warn("warning: " + gap +
                  ": a store lost them, and the client's spool had them no more");
  if (e.snapshot)
    console.say("the estimates stored after record " + std::to_string(*e.snapshot) +
                " are those that the records give");
  if (v.hash_at) console.say("head at " + std::to_string(*a.at) + ": " + to_string(*v.hash_at));
  console.say("head: " + to_string(e.head_hash));
}

std::string json_text(const Verified& v, const VerifyArguments& a) {
  const Reexecuted& e = v.executed;
  nlohmann::ordered_json json;
  json["schema_version"] = 1;
  json["data"] = a.folder;
  json["revision"] = to_string(v.head.revision);
  json["chain_hash"] = to_string(v.head.chain);
  json["cut_tail"] = v.cut_tail ? nlohmann::ordered_json(*v.cut_tail) : nullptr;
  json["records"] = e.records;
  json["accepted"] = e.accepted;
  json["refused"] = e.refused;
  json["commands"] = e.commands;
  json["verdicts"] = e.verdicts;
  json["solves"] = {{"same_bits", e.solves},
                    {"not_bit_comparable", e.solves_compared},
                    {"largest_difference", e.largest_difference},
                    {"unknown_method", e.solves_skipped}};
  json["gaps"] = e.gaps;
  json["snapshot"] = e.snapshot ? nlohmann::ordered_json(*e.snapshot) : nullptr;
  json["settings"] = SolveSettings::here().to_string();
  if (v.hash_at) json["head_hash_at"] = {{"number", *a.at}, {"hash", to_string(*v.hash_at)}};
  json["head_hash"] = to_string(e.head_hash);
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

int run_verify(const VerifyArguments& a) {
  if (Result<void> writable = check_outputs({a.hashes}); !writable) return fail(writable.error());
  const Console console(a.hashes == "-", a.quiet);
  const Result<Verified> verified = verify(a, console);
  if (!verified) return fail(verified.error());
  if (a.json)
    Console(a.hashes == "-", false).say(json_text(*verified, a));
  else
    say_text(*verified, a, console);
  return kDone;
}

}  // namespace

Run add_verify(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<VerifyArguments>();
  verb = parent.add_subcommand("verify", "Check a daemon's data folder by executing it again");
  verb->footer(kVerifyFooter);
  verb->add_option("--data", a->folder, "the data folder")
      ->required()
      ->type_name("DIR")
      ->default_str("");
  verb->add_option("--at", a->at, "also print the hash of the head after this record")
      ->type_name("R");
  verb->add_option("--hashes", a->hashes, "write the hash of the head after every record")
      ->type_name("FILE");
  verb->add_flag("--json", a->json, "print JSON");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a] { return run_verify(*a); };
}

}  // namespace cairn::cli
