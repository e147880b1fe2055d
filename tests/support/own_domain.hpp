// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace cairn::test {

/// A DDS domain that no other test process of this machine has; freed when the process ends.
inline std::uint32_t own_domain() {
  static const std::uint32_t domain = [] {
    constexpr std::uint32_t kFirst = 100, kLast = 229;
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    for (std::uint32_t candidate = kFirst; candidate <= kLast; ++candidate) {
      const std::string name = folder / ("cairn-test-domain-" + std::to_string(candidate));
      const int file = open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return candidate;
      close(file);
    }
    std::abort();  // 130 tests at once
  }();
  return domain;
}

}  // namespace cairn::test
