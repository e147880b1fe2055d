// SPDX-License-Identifier: BSD-3-Clause
// Front-ends as a process: cairn-frontend laser --input LOG --robot NAME [--domain N].
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/core/stopwatch.hpp"
#include "frontends/host/frame_source.hpp"
#include "frontends/host/host.hpp"
#include "frontends/host/loop_closer_host.hpp"
#include "frontends/host/plugins.hpp"

namespace {

constexpr const char* kFooter =
    "Keyframes, odometry and loop closures of a sensor log go to the daemon of the domain. A run "
    "that was interrupted\n"
    "goes on where its spool ends; for a new one, take another --robot or an empty --spool.\n"
    "--input ros takes /scan, /odom and /tf_static of a ROS 2 robot until SIGINT, and publishes "
    "/tf "
    "and /trajectory;\neach run is an epoch of its own. An unknown setting names those there are.\n"
    "Exit codes: 0 everything is durable, 2 usage, 3 bad input, 4 refused, 5 no daemon answers.";

struct Arguments {
  std::string frontend, input, role = "both", spool, trajectory, truth;
  cairn::HostOptions host{};
  double timeout_s = 30.0;
  double until_idle_s = 0.0;
  bool no_odometry = false, settle = false, quiet = false;
};

volatile std::sig_atomic_t interrupted = 0;

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

void tell(const cairn::FrontendHost& host, double seconds) {
  const auto& counts = host.counts();
  const std::string epochs =
      counts.epochs > 1 ? " in " + std::to_string(counts.epochs) + " epochs" : "";
  std::printf(
      "%llu frames%s, %llu keyframes and %llu loop closures in %.1f s; a frame took %.1f ms "
      "(median), %.1f ms (99 %%)\n",
      static_cast<unsigned long long>(counts.frames), epochs.c_str(),
      static_cast<unsigned long long>(counts.keyframes),
      static_cast<unsigned long long>(counts.loops), seconds, 1e3 * percentile(counts.frame_s, 0.5),
      1e3 * percentile(counts.frame_s, 0.99));
}

cairn::Result<void> write_truth(const cairn::FrameSource& input, const Arguments& a) {
  const std::string truth = input.truth();
  if (truth.empty())
    return cairn::Error{cairn::ErrorCode::kUsage, "nobody knows the truth of " + a.input +
                                                      ": --truth is for --input simulated"};
  return cairn::write_file(a.truth, truth);
}

int run_on_input(Arguments& a) {
  auto input = cairn::open_input(a.input, a.host.domain);
  if (!input) return cairn::fail(input.error());
  if ((*input)->is_live() && (a.host.rate_hz > 0.0 || a.host.lockstep))
    return cairn::fail({cairn::ErrorCode::kUsage,
                        "--rate and --lockstep are for logs: a live robot sets the pace"});
  if ((*input)->is_live() && a.no_odometry)
    return cairn::fail({cairn::ErrorCode::kUsage,
                        "--no-odometry is for logs: for a ROS 2 robot without, say ros:odom="});
  if (a.no_odometry) *input = cairn::without_odometry(std::move(*input));
  if (!a.truth.empty()) {
    if (auto written = write_truth(**input, a); !written) return cairn::fail(written.error());
  }
  a.host.keep_frames = !a.trajectory.empty();
  auto host = cairn::FrontendHost::connect(a.host);
  if (!host) return cairn::fail(host.error());
  const cairn::Stopwatch watch;
  const auto done = (*host)->run([&] { return cairn::make_frontend(a.frontend, a.host.roles); },
                                 **input, [] { return interrupted == 0; });
  if (const std::string report = (*input)->report(); !report.empty())
    std::fprintf(stderr, "%s\n", report.c_str());
  if (!done) return cairn::fail(done.error());
  if (!a.quiet) tell(**host, watch.seconds());
  if (a.settle) {
    const auto settled = (*host)->settle();
    if (!settled) return cairn::fail(settled.error());
    if (!a.quiet) std::printf("%s\n", settled->c_str());
  }
  if (a.trajectory.empty()) return 0;
  const auto written = (*host)->write_trajectory(a.trajectory);
  return written ? 0 : cairn::fail(written.error());
}

// Keyframes of all robots come from the daemon.
int run_loop_closer(const Arguments& a) {
  auto host = cairn::LoopCloserHost::connect(a.host);
  if (!host) return cairn::fail(host.error());
  const cairn::Stopwatch watch;
  std::optional<std::chrono::milliseconds> until_idle;
  if (a.until_idle_s > 0.0)
    until_idle = std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * a.until_idle_s));
  const auto done = (*host)->run([&] { return cairn::make_frontend(a.frontend, a.host.roles); },
                                 [] { return interrupted == 0; }, until_idle);
  if (!done) return cairn::fail(done.error());
  const auto& counts = (*host)->counts();
  if (!a.quiet)
    std::printf("%llu keyframes of %zu robots, %llu loop closures in %.1f s\n",
                static_cast<unsigned long long>(counts.keyframes), counts.robots.size(),
                static_cast<unsigned long long>(counts.loops), watch.seconds());
  if (!a.settle) return 0;
  const auto settled = (*host)->settle();
  if (!settled) return cairn::fail(settled.error());
  if (!a.quiet) std::printf("%s\n", settled->c_str());
  return 0;
}

cairn::Result<void> check_arguments(const Arguments& a) {
  const bool only_closes = a.role == "loop-closer";
  const auto usage = [](const char* why) { return cairn::Error{cairn::ErrorCode::kUsage, why}; };
  if (only_closes && (!a.input.empty() || !a.trajectory.empty() || !a.truth.empty() ||
                      a.host.rate_hz > 0.0 || a.host.lockstep || a.no_odometry))
    return usage(
        "--role loop-closer takes the keyframes of all robots from the daemon: no --input, "
        "--rate, --lockstep, --no-odometry, --trajectory or --truth");
  if (!only_closes && a.input.empty()) return usage("--input is required");
  if (!only_closes && a.until_idle_s > 0.0) return usage("--until-idle is for --role loop-closer");
  for (const std::string& file : {a.trajectory, a.truth}) {
    if (file.empty()) continue;
    if (auto writable = cairn::check_writable(file); !writable) return writable;
  }
  return {};
}

int run(Arguments& a) {
  if (auto checked = check_arguments(a); !checked) return cairn::fail(checked.error());
  a.host.roles = {.loop_closer = a.role != "tracker", .tracker = a.role != "loop-closer"};
  a.host.spool = a.spool;
  a.host.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * a.timeout_s));
  if (auto known = cairn::make_frontend(a.frontend, a.host.roles); !known)
    return cairn::fail(known.error());
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  return a.host.roles.tracker ? run_on_input(a) : run_loop_closer(a);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs a front-end: sensor data in, constraints to a Cairn daemon out"};
  app.footer(kFooter);
  app.option_defaults()->always_capture_default();
  Arguments a;
  app.add_option("FRONTEND", a.frontend, "laser, or the path of a shared object")
      ->required()
      ->default_str("");
  app.add_option("--input", a.input,
                 "CARMEN log (text, .gz, .bz2), simulated:SEED, or ros:KEY=VALUE,...: the topics "
                 "of a ROS 2 "
                 "robot; for a loop closer: none")
      ->default_str("")
      ->type_name("LOG");
  app.add_option("--robot", a.host.robot, "whose data it is; a loop closer's own name")
      ->required()
      ->default_str("")
      ->type_name("NAME");
  app.add_option("--domain", a.host.domain, "DDS domain of the daemon")
      ->check(CLI::Range(0, 230).description(""))
      ->type_name("N");
  app.add_option("--role", a.role,
                 "keyframes and odometry alone, or loop closures, too; loop-closer: among the "
                 "keyframes of all robots that the daemon has")
      ->check(CLI::IsMember({"tracker", "loop-closer", "both"}).description(""))
      ->type_name("{tracker|loop-closer|both}");
  app.add_option("--until-idle", a.until_idle_s,
                 "a loop closer ends when no keyframe has come for so long; 0: at SIGINT")
      ->check(CLI::NonNegativeNumber.description(""))
      ->type_name("S");
  app.add_option("--rate", a.host.rate_hz, "frames per second; 0: as fast as it goes")
      ->check(CLI::NonNegativeNumber.description(""))
      ->type_name("HZ");
  app.add_flag("--lockstep", a.host.lockstep,
               "settle the map after each keyframe: every run gives the same bits");
  app.add_flag("--no-odometry", a.no_odometry,
               "leave the odometry of a log out: motion is guessed from the motion before");
  app.add_option("--spool", a.spool, "folder of the spools; else $XDG_STATE_HOME/cairn/spool")
      ->type_name("DIR")
      ->default_str("");
  app.add_option("--timeout", a.timeout_s, "how long to wait for the daemon")->type_name("S");
  app.add_flag("--settle", a.settle, "settle the map afterwards, and print the result");
  app.add_option("--trajectory", a.trajectory,
                 "write where the sensor was at each frame (TUM; `cairn eval` reads it)")
      ->type_name("FILE")
      ->default_str("");
  app.add_option("--truth", a.truth, "write where the simulated sensor truly was (TUM)")
      ->type_name("FILE")
      ->default_str("");
  app.add_flag("-q,--quiet", a.quiet, "say nothing but warnings and errors");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run(a);
}
