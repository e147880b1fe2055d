// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cairn/core/exit_code.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/fleet.hpp"
#include "clients/cli/target.hpp"
#include "clients/cli/verb.hpp"
#include "clients/client/client.hpp"

namespace cairn::cli {
namespace {

struct ReplayArguments {
  std::vector<std::string> files;
  std::uint32_t domain = 0;
  dds::Network network{};
  double rate_hz = 0.0;
  double timeout_s = 30.0;
  std::string spool, prefix;
  std::vector<double> datum;                     // latitude, longitude, height; or nothing
  std::pair<double, double> outage_s{0.0, 0.0};  // from, for
  bool settle = false, quiet = false;
};

constexpr const char* kReplayFooter =
    "A graph file as a live robot: one transaction per pose, in the order of ids, through the same "
    "client that\n"
    "front-ends use. Several files are several robots at once, named after their files; a vertex "
    "belongs to the robot\n"
    "in whose file it stands, and edges to vertices of other files tie robots together. An edge "
    "that stands in two\n"
    "files (within 1e-5) is sent once. To replay a file again, use --prefix, or an empty data "
    "folder and another --spool.\n"
    "Exit codes: 0 every transaction is durable, 2 usage, 3 bad input, 4 refused, 5 no daemon "
    "answers.";

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * seconds));
}

Error refusal(const Receipt& receipt, const FleetRobot& robot) {
  std::string message = "transaction " + std::to_string(receipt.key.sequence) +
                        " was refused: " + std::string(to_string(*receipt.refusal)) + ": " +
                        receipt.reason;
  if (receipt.refusal == RefusalCode::kConflict)
    message += "; the map has robot '" + robot.name +
               "' from a run before: replay it as another one with --prefix, or into an empty data "
               "folder with another --spool (the old spool would refill the folder)";
  return {ErrorCode::kNotUsable, std::move(message), robot.file};
}

// Waits for one receipt.
Result<void> wait(const Submission& submission, const FleetRobot& robot, const ReplayArguments& a) {
  const Result<Receipt> receipt = submission.wait(milliseconds(a.timeout_s));
  if (!receipt) return receipt.error();
  if (receipt->refusal) return refusal(*receipt, robot);
  return {};
}

// One robot's whole file, as far as the daemon takes it. The first receipt is waited for: where
// the nodes are there already, nothing more is sent.
Result<void> send(FleetRobot& robot, const ReplayArguments& a, Client& client) {
  std::vector<Submission> waiting;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < robot.transactions.size(); ++i) {
    if (a.rate_hz > 0.0) {
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<std::chrono::nanoseconds>(
                      std::chrono::duration<double>(static_cast<double>(i) / a.rate_hz)));
    }
    Result<Submission> taken = client.submit_async(std::move(robot.transactions[i]));
    if (!taken) return taken.error();
    if (i == 0) {
      if (auto first = wait(*taken, robot, a); !first) return first;
    } else {
      waiting.push_back(std::move(*taken));
    }
  }
  for (const Submission& submission : waiting) {
    if (auto durable = wait(submission, robot, a); !durable) return durable;
  }
  return {};
}

Result<Client> connect(const FleetRobot& robot, const ReplayArguments& a) {
  ClientOptions options;
  options.domain = a.domain;
  options.network = a.network;
  options.source = "replay-" + robot.name;
  options.robot = robot.name;
  if (!a.spool.empty()) options.spool = std::filesystem::path(a.spool) / options.source;
  Result<Client> client = Client::connect(options);
  if (client && client->undecided() > 0)
    Console::warn("warning: " + robot.file + ": " + std::to_string(client->undecided()) +
                  " transactions of an earlier run are in the spool, and are sent first");
  return client;
}

// Cuts the link for a while, as asked for.
void suffer_outage(const ReplayArguments& a, const Console& console) {
  const auto [from, length] = a.outage_s;
  if (!(length > 0.0)) return;
  std::this_thread::sleep_for(milliseconds(from));
  if (auto cut = dds::cut_link(a.domain, milliseconds(length)); !cut)
    return Console::warn("warning: " + cut.error().to_string());
  char text[64];
  std::snprintf(text, sizeof text, "the link is down for %g s", length);
  console.say(text);
  std::this_thread::sleep_for(milliseconds(length));
  console.say("the link is up again");
}

// All robots at once, each through a client of its own.
Result<void> send_all(Fleet& fleet, const ReplayArguments& a, const Console& console,
                      std::vector<Client>& clients) {
  for (const FleetRobot& robot : fleet.robots) {
    Result<Client> client = connect(robot, a);
    if (!client) return client.error();
    clients.push_back(std::move(*client));
  }
  std::vector<Result<void>> sent(fleet.robots.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < fleet.robots.size(); ++i)
    threads.emplace_back([&, i] { sent[i] = send(fleet.robots[i], a, clients[i]); });
  suffer_outage(a, console);
  for (std::thread& thread : threads) thread.join();
  for (const Result<void>& result : sent) {
    if (!result) return result;
  }
  return {};
}

Result<void> set_datum(Fleet& fleet, const std::vector<double>& numbers) {
  if (numbers.empty()) return {};
  const Geodetic datum{numbers[0], numbers[1], numbers[2]};
  if (!is_place(datum))
    return Error{
        ErrorCode::kUsage,
        "--datum expects latitude, longitude (deg) and height (m), found " + to_string(datum)};
  for (FleetRobot& robot : fleet.robots)
    for (Transaction& transaction : robot.transactions)
      for (NewFactor& factor : transaction.factors) set_datum(factor, datum);
  return {};
}

int run_replay(const ReplayArguments& a) {
  const Console console(false, a.quiet);
  Result<Fleet> fleet = read_fleet(a.files, a.prefix);
  if (!fleet) return fail(fleet.error());
  for (const std::string& warning : fleet->warnings) Console::warn("warning: " + warning);
  if (auto set = set_datum(*fleet, a.datum); !set) return fail(set.error());
  std::vector<std::size_t> counts;
  for (const FleetRobot& robot : fleet->robots) counts.push_back(robot.transactions.size());
  std::vector<Client> clients;
  if (auto sent = send_all(*fleet, a, console, clients); !sent) return fail(sent.error());
  for (std::size_t i = 0; i < counts.size(); ++i)
    console.say(fleet->robots[i].file + ": " + std::to_string(counts[i]) +
                " transactions are durable");
  if (!a.settle) return kDone;
  const Result<std::string> settled = clients.front().command("settle", std::chrono::minutes(10));
  if (!settled) return fail(settled.error());
  console.say(*settled);
  return kDone;
}

}  // namespace

Run add_replay(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ReplayArguments>();
  verb = parent.add_subcommand("replay", "Send graph files to a daemon, as live robots would");
  verb->footer(kReplayFooter);
  verb->add_option("FILE", a->files, "graph files, one per robot")->required()->default_str("");
  verb->add_option("--domain", a->domain, "DDS domain of the daemon")->check(in_range(0, 230));
  add_network(*verb, a->network);
  verb->add_option("--rate", a->rate_hz, "poses per second; 0: as fast as it goes")
      ->check(CLI::NonNegativeNumber.description(""))
      ->type_name("HZ");
  verb->add_option("--timeout", a->timeout_s, "how long to wait for the daemon")->type_name("S");
  verb->add_option("--spool", a->spool, "folder of the spools; else $XDG_STATE_HOME/cairn/spool")
      ->type_name("DIR");
  verb->add_option("--prefix", a->prefix, "put this before the robots' names")
      ->type_name("TEXT")
      ->default_str("");
  verb->add_option(
          "--datum", a->datum,
          "where on earth the origin of the files' GNSS positions lies (deg, m; WGS-84), x "
          "to the east and y to the north")
      ->expected(3)
      ->type_name("LAT LON HEIGHT")
      ->default_str("");
  verb->add_option("--outage", a->outage_s,
                   "cut the link after so many seconds, for so many: to see that nothing is lost")
      ->type_name("FROM FOR")
      ->check(CLI::NonNegativeNumber.description(""))
      ->default_str("");
  verb->add_flag("--settle", a->settle, "settle afterwards, and print the result");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a] { return run_replay(*a); };
}

}  // namespace cairn::cli
