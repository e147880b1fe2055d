// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "cairn/history/question.hpp"
#include "clients/client/client.hpp"

namespace cairn::cli {

/// Whom a verb asks: the daemon that serves a domain or, where a folder is named, its data folder.
struct Target {
  std::uint32_t domain = 0;
  dds::Network network{};
  std::string folder;
  double timeout_s = 5.0;  ///< for a daemon to appear

  [[nodiscard]] bool is_folder() const { return !folder.empty(); }
};

/// Adds --domain, --data, --timeout, --profile and --interface.
void add_target(CLI::App& verb, Target& target);
/// The same without --data: for what only a daemon knows.
void add_daemon(CLI::App& verb, Target& target);
/// Adds --profile and --interface: how a daemon on another machine is reached.
void add_network(CLI::App& verb, dds::Network& network);

/// A client that watches and commands, and the daemon's first word. kUnreachable where none
/// answers, with what to do. `options` but where the target says it.
struct Connection {
  Client client;
  Status status;
};
Result<Connection> connect(const Target& target, ClientOptions options = {});

/// The journal of a folder, for reading.
Result<std::unique_ptr<Journal>> open_for_reading(const std::string& folder);

/// Reads all of a folder's journal. Verbs that write to a folder ask first: opening a damaged one
/// for writing would mend it, and that is the daemon's to do.
Result<void> check_sound(const std::string& folder);

/// A sound folder, open for writing, and the map at its end.
struct OpenFolder {
  std::unique_ptr<Journal> journal;
  MapHead head;
};
Result<OpenFolder> open_for_writing(const std::string& folder);

/// For answers that take a daemon some work.
inline constexpr std::chrono::minutes kLongWork{10};
/// The answer of the daemon, for which `patience` waits once one is there, or of the folder: the
/// same text.
Result<std::string> ask(const Target& target, const Question& question,
                        std::chrono::seconds patience = kLongWork);
/// Prints it, and gives the exit code.
int ask_and_print(const Target& target, const Question& question,
                  std::chrono::seconds patience = kLongWork);

}  // namespace cairn::cli
