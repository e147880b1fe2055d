// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {

/// A store that is open and trusted.
struct OpenedStore {
  std::unique_ptr<Store> store;
  StoreIdentity identity;
  ChainPoint head;
  OpenReport report;
};

/// Opens the store of a data folder, makes it where there is none, and replaces it by its good
/// beginning where it is damaged. Every step may be the last before a power loss: the next call
/// goes on from there.
Result<OpenedStore> open_store(const DataFolder& folder, const JournalOptions& options);

/// Opens the store of a data folder as it is. Changes nothing: what open_store() would mend is an
/// error that says so, but for a torn tail, which is left out and reported.
Result<OpenedStore> open_store_for_reading(const DataFolder& folder, const JournalOptions& options);

}  // namespace cairn
