// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include "cairn/core/result.hpp"

namespace cairn {

/// Prints an error to standard error, place first, and gives the exit code that belongs to it.
inline int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.to_string().c_str());
  return static_cast<int>(error.code);
}

/// 0, or what fail() gives.
inline int exit_code(const Result<void>& result) { return result ? 0 : fail(result.error()); }

}  // namespace cairn
