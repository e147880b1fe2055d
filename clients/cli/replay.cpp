// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/graph_transactions.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cairn/core/exit_code.hpp"
#include "cairn/io/graph_file.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/verb.hpp"
#include "clients/client/client.hpp"

namespace cairn::cli {
namespace {

struct ReplayArguments {
  std::vector<std::string> files;
  std::uint32_t domain = 0;
  double rate_hz = 0.0;
  double timeout_s = 30.0;
  std::string spool;
  bool settle = false, quiet = false;
};

constexpr const char* kFooter =
    "A graph file as a live robot: one transaction per pose, in the order of ids, through the same "
    "client that\n"
    "front-ends use. Several files are several robots, named after their files; the top byte of an "
    "id is the robot\n"
    "where files name the same poses.\n"
    "Exit codes: 0 every transaction is durable, 3 bad input, 4 refused, 5 no daemon answers.";

std::string robot_of(const std::string& file) {
  std::string name = std::filesystem::path(file).filename().string();
  if (const auto dot = name.find('.'); dot != std::string::npos) name.resize(dot);
  return name.substr(0, 64);
}

// One robot's whole file, as far as the daemon takes it.
Result<std::size_t> send(const std::string& file, const Graph& graph, const ReplayArguments& a,
                         Client& client) {
  const std::string robot = robot_of(file);
  std::vector<Transaction> transactions = graph_transactions(graph, [&](VariableId id) {
    return NodeId{{robot, 0}, id.value};
  });
  const auto timeout = std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * a.timeout_s));
  std::vector<Submission> waiting;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < transactions.size(); ++i) {
    if (a.rate_hz > 0.0) {
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<std::chrono::nanoseconds>(
                      std::chrono::duration<double>(static_cast<double>(i) / a.rate_hz)));
    }
    Result<Submission> taken = client.submit_async(std::move(transactions[i]));
    if (!taken) return taken.error();
    waiting.push_back(std::move(*taken));
  }
  for (const Submission& submission : waiting) {
    const Result<Receipt> receipt = submission.wait(timeout);
    if (!receipt) return receipt.error();
    if (receipt->refusal) {
      return Error{ErrorCode::kNotUsable,
                   "transaction " + std::to_string(receipt->key.sequence) + " was refused: " +
                       std::string(to_string(*receipt->refusal)) + ": " + receipt->reason,
                   file};
    }
  }
  return waiting.size();
}

int run_replay(const ReplayArguments& a) {
  const Console console(false, a.quiet);
  for (const std::string& file : a.files) {
    Result<GraphDocument> document = read_graph(file);
    if (!document) return fail(document.error());
    for (const std::string& warning : document->warnings) Console::warn("warning: " + warning);
    ClientOptions options;
    options.domain = a.domain;
    options.source = "replay-" + robot_of(file);
    options.robot = robot_of(file);
    if (!a.spool.empty()) options.spool = std::filesystem::path(a.spool) / options.source;
    Result<Client> client = Client::connect(options);
    if (!client) return fail(client.error());
    const Result<std::size_t> sent = send(file, document->graph, a, *client);
    if (!sent) return fail(sent.error());
    console.say(file + ": " + std::to_string(*sent) + " transactions are durable");
    if (!a.settle) continue;
    const Result<std::string> settled = client->command("settle", std::chrono::minutes(10));
    if (!settled) return fail(settled.error());
    console.say(*settled);
  }
  return kDone;
}

}  // namespace

Run add_replay(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<ReplayArguments>();
  verb = parent.add_subcommand("replay", "Send graph files to a daemon, as live robots would");
  verb->footer(kFooter);
  verb->add_option("FILE", a->files, "graph files, one per robot")->required()->default_str("");
  verb->add_option("--domain", a->domain, "DDS domain of the daemon")->check(CLI::Range(0, 232));
  verb->add_option("--rate", a->rate_hz, "poses per second; 0: as fast as it goes")
      ->check(CLI::NonNegativeNumber)
      ->type_name("HZ");
  verb->add_option("--timeout", a->timeout_s, "how long to wait for the daemon")->type_name("S");
  verb->add_option("--spool", a->spool, "folder of the spools; else $XDG_STATE_HOME/cairn/spool")
      ->type_name("DIR");
  verb->add_flag("--settle", a->settle, "settle afterwards, and print the result");
  verb->add_flag("-q,--quiet", a->quiet, "say nothing but warnings and errors");
  return [a] { return run_replay(*a); };
}

}  // namespace cairn::cli
