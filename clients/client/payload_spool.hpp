// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"

namespace cairn {

/// Payloads on disk until the daemon has stored them: one file each, whole or not there. The folder
/// belongs to a Spool, whose lock protects it. One thread at a time.
class PayloadSpool {
 public:
  struct Kept {
    ContentHash hash{};
    std::uint64_t bytes = 0;  ///< of the file
  };
  struct Content {
    std::string type;
    std::string bytes;
  };

  /// Makes the folder where it is not there. kBadInput (with the file) where one is damaged.
  static Result<PayloadSpool> open(const std::filesystem::path& folder, std::uint64_t most_bytes);

  /// By number, ascending.
  [[nodiscard]] const std::map<std::uint64_t, Kept>& kept() const { return kept_; }
  /// Returns its number when it is on disk. kNotUsable "spool full" beyond the bound.
  Result<std::uint64_t> append(std::string_view type, std::string_view bytes);
  [[nodiscard]] Result<Content> read(std::uint64_t number) const;
  void remove(std::uint64_t number);

 private:
  PayloadSpool(std::filesystem::path folder, std::uint64_t most_bytes)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}
  [[nodiscard]] std::filesystem::path path_of(std::uint64_t number) const;

  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
  std::uint64_t bytes_ = 0;
  std::uint64_t next_ = 1;
  std::map<std::uint64_t, Kept> kept_;
};

}  // namespace cairn
