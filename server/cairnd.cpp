// SPDX-License-Identifier: BSD-3-Clause
// The daemon: cairnd --data DIR [--domain N].
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "cairn/core/exit_code.hpp"
#include "server/dds_transport.hpp"
#include "server/service.hpp"

namespace {

void log_opening(const std::string& folder, const cairn::Journal& journal) {
  const cairn::OpenReport& report = journal.open_report();
  spdlog::info("{} {}: revision {}", report.created ? "created" : "opened", folder,
               cairn::to_string(journal.head().revision));
  if (report.cut_tail)
    spdlog::warn("cut a write that never finished, nothing acknowledged is lost: {}",
                 *report.cut_tail);
  if (report.damage) {
    spdlog::error("damaged: {}; records up to {} are served, the rest is in {}; era {}",
                  report.damage->what, report.damage->kept, report.damage->set_aside,
                  report.damage->era);
  }
}

int serve(const std::string& folder, std::uint32_t domain) {
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigaddset(&ending, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);  // for every thread to come
  signal(SIGXFSZ, SIG_IGN);                      // a full disk is an error, not an end
  signal(SIGPIPE, SIG_IGN);

  auto journal = cairn::Journal::open(folder);
  if (!journal) return cairn::fail(journal.error());
  log_opening(folder, **journal);
  const auto transport = cairn::make_dds_transport({.domain = domain});
  cairn::Service service(**journal, *transport);
  if (auto started = service.start(); !started) return cairn::fail(started.error());
  spdlog::info("serving domain {}", domain);
  while (true) {
    const timespec second{1, 0};
    const int signal_number = sigtimedwait(&ending, nullptr, &second);
    if (signal_number > 0) {
      spdlog::info("ending: signal {}", signal_number);
      break;
    }
    if (const auto failure = service.failure()) {
      service.stop();
      return cairn::fail(*failure);
    }
  }
  service.stop();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Cairn's map server: takes constraints over DDS, keeps them, sends poses back"};
  std::string folder;
  std::uint32_t domain = 0;
  app.add_option("--data", folder, "folder of the journal; made if absent")->required();
  app.add_option("--domain", domain, "DDS domain")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("cairnd"));
  return serve(folder, domain);
}
