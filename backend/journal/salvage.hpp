// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {

/// Holds a copy of a damaged store while it is read; may be deleted at any time.
inline constexpr char kRepairFolder[] = "repairing";

/// The highest number of a record in a table file; 0 where there is none or it cannot be read.
std::uint64_t last_record_of_table(Store& store, const std::string& file);

/// Opens what is left of the store `name` of a data folder, without changing it: as its MANIFEST
/// says or, where this gives more records, by its files alone. Null where nothing can be read.
std::unique_ptr<Store> open_remains(const DataFolder& folder, const std::string& name,
                                    const Store::Settings& settings);

/// Copies the records up to the first flaw, and every whole payload. Tells `damage` how many.
rocksdb::Status copy_good_part(Store& remains, Store& fresh, OpenReport::Damage& damage);

}  // namespace cairn
