// SPDX-License-Identifier: BSD-3-Clause
#include "server/daemon.hpp"

#include <signal.h>

#include <cstdlib>

#include "cairn/core/exit_code.hpp"
#include "server/dds_transport.hpp"
#include "server/log.hpp"

namespace cairn {
namespace {

// The signals that end the daemon; for every thread to come they wait until somebody asks.
sigset_t block_ending_signals() {
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigaddset(&ending, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);
  signal(SIGXFSZ, SIG_IGN);  // a full disk is an error, not an end
  signal(SIGPIPE, SIG_IGN);
  return ending;
}

// Zero when a signal came, else what ended the service by itself.
int wait_for_end(const sigset_t& ending, const Service& service) {
  while (true) {
    constexpr timespec kPoll{0, 200'000'000};
    const int signal_number = sigtimedwait(&ending, nullptr, &kPoll);
    if (signal_number > 0) {
      log(Severity::kInfo, "ending", "signal " + std::to_string(signal_number));
      return 0;
    }
    if (const auto failure = service.failure()) {
      log(Severity::kError, "failed", failure->to_string());
      return static_cast<int>(failure->code);
    }
  }
}

// Null where the configuration asks for none.
Result<std::unique_ptr<RosMap>> open_ros_map(const DaemonConfig& config) {
  if (config.ros.map.empty()) return std::unique_ptr<RosMap>();
  if (!config.service.maps.enabled)
    return Error{ErrorCode::kBadInput,
                 "ros.map is '" + config.ros.map + "', but maps.enabled is false: there is none"};
  RosMapOptions options = config.ros;
  options.network = config.network;
  return RosMap::open(std::move(options), [](const Error& error) {
    log(Severity::kWarning, "ros", error.to_string());
  });
}

}  // namespace

int run_daemon(const std::string& folder, const DaemonConfig& config,
               const JournalOptions& journal_options) {
  const sigset_t ending = block_ending_signals();
  open_log(config.log_format, config.log_from);
  auto journal = Journal::open(folder, journal_options);
  if (!journal) return fail(journal.error());
  log(Severity::kInfo, "opened", ((*journal)->open_report().created ? "made " : "") + folder,
      (*journal)->head().revision);
  const auto transport = make_dds_transport({.domain = config.domain, .network = config.network});
  const auto ros_map = open_ros_map(config);  // outlives the service
  if (!ros_map) return fail(ros_map.error());
  ServiceOptions options = config.service;
  if (*ros_map) {
    options.maps.on_map = [&map = **ros_map](const MapChange& change) {
      map.take(change.map, change.changed, change.gone, change.resolution_m);
    };
    log(Severity::kInfo, "ros",
        "the map is " + config.ros.map + " of ROS domain " + std::to_string(config.ros.domain));
  }
  options.on_event = [](const Event& event) {
    log(event.severity, event.kind, event.text, event.revision);
  };
  Service service(**journal, *transport, std::move(options));
  if (auto started = service.start(); !started) return fail(started.error());
  log(Severity::kInfo, "serving", "domain " + std::to_string(config.domain),
      (*journal)->head().revision);
  const int exit_code = wait_for_end(ending, service);
  if (!service.stop(std::chrono::seconds(1))) {
    // The solver or a backup is inside one long step. What is durable stays so.
    std::_Exit(exit_code);
  }
  return exit_code;
}

}  // namespace cairn
