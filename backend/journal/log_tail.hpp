// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "cairn/journal/data_folder.hpp"

namespace cairn {

/// Where the write-ahead logs of a store stop being whole, as "FILE, byte N: what".
struct LogInspection {
  /// The last write did not finish. Nothing was written after it, so it was not acknowledged.
  std::optional<std::string> torn_tail{};
  /// Something is broken that a later write follows: it was whole once, and acknowledged.
  std::optional<std::string> damage{};
};

/// RocksDB's own recovery cannot tell the two apart. Every write waits for the sync of the one
/// before it, so a whole write behind a broken one proves damage.
LogInspection inspect_logs(const DataFolder& folder, const std::string& store);

/// A file of a data folder whose last write did not finish.
struct TornFile {
  std::string name;
  std::uint64_t good_end = 0;  ///< bytes that are whole
  std::string what;            ///< "FILE, byte N: what"
};

/// A last write to the MANIFEST that did not finish: what it was to say was not acted upon yet.
/// RocksDB takes some of these for damage. Nothing where the MANIFEST is whole, or broken
/// otherwise.
std::optional<TornFile> find_torn_manifest(const DataFolder& folder, const std::string& store);
/// Cuts it off. Gives what was cut.
Result<std::optional<std::string>> cut_torn_manifest(const DataFolder& folder,
                                                     const std::string& store);

/// Visits the whole writes of a log file up to its first flaw, each as a WriteBatch has it.
void for_each_write(std::string_view log, const std::function<void(std::string_view)>& visit);

}  // namespace cairn
