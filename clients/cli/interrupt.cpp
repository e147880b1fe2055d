// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/interrupt.hpp"

namespace cairn::cli {
namespace {

volatile std::sig_atomic_t interrupt_flag = 0;

void raise_flag(int) { interrupt_flag = 1; }

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupt_flag = 0;
  struct sigaction action {};
  action.sa_handler = raise_flag;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, &previous_);
  // A shell script's background job ignores Ctrl-C; so do we.
  if (previous_.sa_handler == SIG_IGN) sigaction(SIGINT, &previous_, nullptr);
}

InterruptGuard::~InterruptGuard() { sigaction(SIGINT, &previous_, nullptr); }

bool InterruptGuard::interrupted() { return interrupt_flag != 0; }

}  // namespace cairn::cli
