// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/target.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>

#include "cairn/core/exit_code.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/verb.hpp"
#include "server/replay_journal.hpp"

namespace cairn::cli {
namespace {

// What the client's thread hands over.
struct FirstStatus {
  std::mutex mutex;
  std::condition_variable arrived;
  std::optional<Status> status;
};

Result<std::string> ask_folder(const std::string& folder, const Question& question) {
  const auto journal = open_for_reading(folder);
  if (!journal) return journal.error();
  const auto map = [&]() -> Result<PoseGraph> {
    auto maps = maps_at(**journal, {(*journal)->head().revision.number});
    if (!maps) return maps.error();
    return std::move(maps->front());
  };
  return answer(question, {**journal, map});
}

}  // namespace

void add_network(CLI::App& verb, dds::Network& network) {
  const Choices<dds::Profile> profiles{{"local", dds::Profile::kLocal},
                                       {"radio", dds::Profile::kRadio}};
  add_choice(verb, "--profile", network.profile, profiles,
             "DDS settings, as in the daemon's configuration");
  verb.add_option("--interface", network.interface,
                  "network interface to the daemon, such as eth0; else this machine only (radio: "
                  "its first one)")
      ->type_name("NAME")
      ->default_str("");
}

void add_daemon(CLI::App& verb, Target& target) {
  verb.add_option("--domain", target.domain, "ask the daemon that serves this DDS domain")
      ->check(in_range(0, 230))
      ->type_name("N");
  verb.add_option("--timeout", target.timeout_s, "how long to look for the daemon, seconds")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("S");
  add_network(verb, target.network);
}

void add_target(CLI::App& verb, Target& target) {
  add_daemon(verb, target);
  verb.add_option("--data", target.folder, "read this data folder, which no daemon may serve")
      ->excludes("--domain")
      ->default_str("")
      ->type_name("DIR");
}

Result<Connection> connect(const Target& target, ClientOptions options) {
  options.domain = target.domain;
  options.network = target.network;
  auto client = Client::connect(options);
  if (!client) return client.error();
  const auto first = std::make_shared<FirstStatus>();
  client->on_status([first](const Status& status) {
    {
      const std::lock_guard lock(first->mutex);
      first->status = status;
    }
    first->arrived.notify_all();
  });
  std::unique_lock lock(first->mutex);
  const auto here = [&] { return first->status.has_value(); };
  if (first->arrived.wait_for(lock, std::chrono::duration<double>(target.timeout_s), here)) {
    Status status = *first->status;
    lock.unlock();
    return Connection{std::move(*client), std::move(status)};
  }
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%g", target.timeout_s);
  const std::string domain = std::to_string(target.domain);
  return Error{ErrorCode::kUnreachable,
               "no daemon answers in domain " + domain + " within " + seconds +
                   " s; start one (cairnd --data DIR --domain " + domain +
                   "), name its domain with --domain, or a folder with --data"};
}

Result<std::unique_ptr<Journal>> open_for_reading(const std::string& folder) {
  JournalOptions options;
  options.read_only = true;
  return Journal::open(folder, options);
}

Result<void> check_sound(const std::string& folder) {
  const auto journal = open_for_reading(folder);
  if (!journal) return journal.error();
  return (*journal)->verify();
}

Result<OpenFolder> open_for_writing(const std::string& folder) {
  if (const auto sound = check_sound(folder); !sound) return sound.error();
  auto journal = Journal::open(folder);
  if (!journal) return journal.error();
  OpenFolder open{std::move(*journal), {}};
  Sequencer sequencer;
  if (const auto replayed = replay_journal(*open.journal, open.head, sequencer); !replayed)
    return replayed.error();
  return open;
}

Result<std::string> ask(const Target& target, const Question& question,
                        std::chrono::seconds patience) {
  if (const auto sound = question.check_text(); !sound) return sound.error();
  if (target.is_folder()) return ask_folder(target.folder, question);
  Result<Connection> connection = connect(target);
  if (!connection) return connection.error();
  return connection->client.command(question.to_string(), patience);
}

int ask_and_print(const Target& target, const Question& question, std::chrono::seconds patience) {
  const Result<std::string> text = ask(target, question, patience);
  if (!text) return fail(text.error());
  std::fwrite(text->data(), 1, text->size(), stdout);
  return std::fflush(stdout) == 0 ? kDone : kInternalError;
}

}  // namespace cairn::cli
