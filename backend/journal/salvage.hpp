// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {

/// Holds what was found in a damaged store while it is read; may be deleted at any time.
inline constexpr char kGatheringFolder[] = "gathering";

/// The highest number of a record in a table file; 0 where there is none or it cannot be read.
std::uint64_t last_record_of_table(Store& store, const std::string& file);

/// Collects every record and payload that a whole part of a table, blob or log file of the store
/// `name` holds, whatever its CURRENT and MANIFEST say, in kGatheringFolder, which must not exist.
/// Null where there is no store or no room.
std::unique_ptr<Store> gather_remains(const DataFolder& folder, const std::string& name,
                                      const Store::Settings& settings);

/// Copies the records up to the first flaw, and every whole payload. Tells `damage` how many.
rocksdb::Status copy_good_part(Store& remains, Store& fresh, OpenReport::Damage& damage);

}  // namespace cairn
