// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "cairn/journal/data_folder.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {

/// A snapshot of estimates, after the record at `at`.
struct StoredSnapshot {
  ChainPoint at;
  std::string bytes;
};

/// Writes snapshots/NUMBER and deletes all but the two newest valid ones.
Result<void> write_snapshot_file(const DataFolder& folder, Store& store, const ChainPoint& at,
                                 std::string_view bytes);
/// The newest one that is whole and whose chain hash is that of its record in `store`.
std::optional<StoredSnapshot> read_newest_snapshot(const DataFolder& folder, Store& store);

}  // namespace cairn
