// SPDX-License-Identifier: BSD-3-Clause
// A robot that drives until SIGTERM: killable_client DOMAIN SPOOL ROBOT RECEIPTS. It goes on where
// its spool ends, and appends to RECEIPTS each receipt that it got: `sequence number-of-record`.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <thread>

#include "clients/client/client.hpp"
#include "tests/server/drive.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

volatile sig_atomic_t ending = 0;

int failed(const Error& error) {
  std::fprintf(stderr, "%s\n", error.to_string().c_str());
  return 1;
}

int run(char** argv) {
  signal(SIGTERM, [](int) { ending = 1; });
  const std::string robot = argv[3];
  const int receipts = open(argv[4], O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  Result<Client> client =
      Client::connect({.domain = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)),
                       .source = robot,
                       .robot = robot,
                       .spool = argv[2],
                       .retry_first = 5ms,
                       .retry_most = 50ms});
  if (!client) return failed(client.error());
  while (!ending) {
    // A long run is one of many kills, not of a large map.
    const std::uint64_t length = client->next_sequence() < 400 ? 8 : 2;
    std::vector<Submission> burst;
    for (std::uint64_t i = 0; i < length; ++i) {
      Result<Submission> taken =
          client->submit_async(test::troubled_step(robot, client->next_sequence() - 1));
      if (!taken) return failed(taken.error());
      burst.push_back(std::move(*taken));
    }
    for (const Submission& submission : burst) {
      Result<Receipt> receipt = submission.wait(60s);
      if (!receipt) return failed(receipt.error());
      if (receipt->refusal) return failed({ErrorCode::kNotUsable, receipt->reason});
      const std::string line = std::to_string(receipt->key.sequence) + ' ' +
                               std::to_string(receipt->revision.number) + '\n';
      if (write(receipts, line.data(), line.size()) < 0) return 1;
    }
    std::this_thread::sleep_for(150ms);  // the daemon solves meanwhile
  }
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return argc == 5 ? cairn::run(argv) : 2; }
