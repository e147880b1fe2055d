// SPDX-License-Identifier: BSD-3-Clause
// A robot on its course (course.hpp), a step every PERIOD milliseconds, then REVISITS steps, one
// every PAUSE milliseconds, then none:
//   soak_robot DOMAIN SPOOL ROBOT(0..2) RECEIPTS SEED POSES PERIOD PAUSE REVISITS
// It goes on where its spool ends, and appends to RECEIPTS each receipt that it got: `sequence
// number-of-record`. SIGUSR1: when all is decided it prints how many steps there were, and stands
// still, connected, until SIGTERM.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "clients/client/client.hpp"
#include "tests/soak/course.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

volatile sig_atomic_t ending = 0, standing = 0;

int failed(const Error& error) {
  std::fprintf(stderr, "%s\n", error.to_string().c_str());
  return 1;
}

Result<void> take_step(Client& client, test::Course& course, int receipts) {
  const Result<Submission> taken =
      client.submit_async(course.step(client.next_sequence() - 1).transaction);
  if (!taken) return taken.error();
  const Result<Receipt> receipt = taken->wait(5min);  // the daemon may be away
  if (!receipt) return receipt.error();
  if (receipt->refusal) return Error{ErrorCode::kNotUsable, receipt->reason};
  const std::string line =
      std::to_string(receipt->key.sequence) + ' ' + std::to_string(receipt->revision.number) + '\n';
  if (write(receipts, line.data(), line.size()) < 0)
    return Error{ErrorCode::kInternal, "cannot write the receipt"};
  return {};
}

void stand_still(const Client& client) {
  while (!ending && client.undecided() > 0) std::this_thread::sleep_for(10ms);
  std::printf("%llu\n", static_cast<unsigned long long>(client.next_sequence() - 1));
  std::fflush(stdout);
  while (!ending) std::this_thread::sleep_for(10ms);
}

int run(char** argv) {
  signal(SIGTERM, [](int) { ending = 1; });
  signal(SIGUSR1, [](int) { standing = 1; });
  const auto number = [&](int i) { return std::strtoull(argv[i], nullptr, 10); };
  const std::size_t robot = number(3) % test::Course::kRobots.size();
  const std::string name = test::Course::kRobots[robot];
  const int receipts = open(argv[4], O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  test::Course course(number(5), robot, number(6));
  Result<Client> client = Client::connect({.domain = static_cast<std::uint32_t>(number(1)),
                                           .source = name,
                                           .robot = name,
                                           .spool = argv[2]});
  if (!client) return failed(client.error());
  auto next = std::chrono::steady_clock::now();
  while (!ending) {
    const bool drives = client->next_sequence() <= number(6);
    next += std::chrono::milliseconds(drives ? number(7) : number(8));
    while (!ending && std::chrono::steady_clock::now() < next) std::this_thread::sleep_for(5ms);
    if (ending) break;
    if (standing) {
      stand_still(*client);
      break;
    }
    if (client->next_sequence() > number(6) + number(9)) continue;
    if (auto done = take_step(*client, course, receipts); !done) return failed(done.error());
  }
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return argc == 10 ? cairn::run(argv) : 2; }
