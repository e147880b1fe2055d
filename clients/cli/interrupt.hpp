// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>

namespace cairn::cli {

/// While it lives the first Ctrl-C (SIGINT) only raises a flag; a second one ends the program as
/// usual.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] static bool interrupted();

 private:
  struct sigaction previous_ {};
};

}  // namespace cairn::cli
