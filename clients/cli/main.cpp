// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include "clients/cli/app.hpp"

int main(int argc, char** argv) {
  try {
    return cairn::cli::CommandLine().run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cairn: internal error: %s\n", error.what());
    return cairn::cli::kInternalError;
  }
}
