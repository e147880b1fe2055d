// SPDX-License-Identifier: BSD-3-Clause
// Opening for those who only look: what recovery.cpp mends is told here, and left as it is.
#include <algorithm>
#include <set>

#include "cairn/journal/log_tail.hpp"
#include "cairn/journal/recovery.hpp"
#include "cairn/journal/salvage.hpp"

namespace cairn {
namespace {

constexpr char kStore[] = "store";

Error damage(const std::string& what, const std::string& place) {
  return {ErrorCode::kBadInput,
          "damaged: " + what +
              "; nothing was changed. Copy the folder, then start cairnd on it: it serves the "
              "records before the flaw and keeps the rest aside",
          place};
}

// Tables that the MANIFEST does not name are leftovers, unless they hold records above the head.
std::optional<Error> find_lost_table(const DataFolder& folder, Store& store, std::uint64_t head) {
  std::vector<rocksdb::LiveFileMetaData> live;
  store.db().GetLiveFilesMetaData(&live);
  std::set<std::string> known;
  for (const auto& file : live) known.insert(file.name.substr(file.name.rfind('/') + 1));
  for (const std::string& name : folder.list(kStore)) {
    if (!name.ends_with(".sst") || known.contains(name)) continue;
    const std::string file = folder.path(kStore) + '/' + name;
    if (last_record_of_table(store, file) > head)
      return damage("the MANIFEST has lost this table of records", file);
  }
  return std::nullopt;
}

Error not_there(const DataFolder& folder, bool has_identity) {
  if (folder.has("rebuilt"))
    return {ErrorCode::kBadInput, "mending was interrupted; start cairnd on the folder, it goes on",
            folder.path()};
  if (has_identity) return damage("the folder with the records is missing", folder.path(kStore));
  return {
      ErrorCode::kBadInput,
      "there is no journal here; expected a data folder of cairnd, which holds STORE and store/",
      folder.path()};
}

}  // namespace

Result<OpenedStore> open_store_for_reading(const DataFolder& folder,
                                           const JournalOptions& options) {
  const Result<std::optional<StoreIdentity>> identity = folder.read_identity();
  if (!identity) return identity.error();
  if (!folder.has(kStore)) return not_there(folder, identity->has_value());
  OpenedStore opened;
  const Store::Settings settings{options.write_buffer_bytes};
  const auto open = [&](Store::Mode mode) {
    return Store::open(folder.path(kStore), folder.files(), mode, settings, opened.store);
  };
  rocksdb::Status status = open(Store::Mode::kInspect);
  if (status.IsCorruption()) {
    const LogInspection logs = inspect_logs(folder, kStore);
    if (logs.damage) return damage(*logs.damage, folder.path(kStore));
    opened.report.cut_tail = logs.torn_tail;
    if (logs.torn_tail) status = open(Store::Mode::kInspectCut);
  }
  if (status.IsIOError() && !status.IsPathNotFound())
    return storage_error(status, folder.path(kStore));
  if (!status.ok()) return damage(status.ToString(), folder.path(kStore));
  const Result<ChainPoint> head = opened.store->read_head();
  if (!head) return damage(head.error().message, head.error().place);
  if (auto lost = find_lost_table(folder, *opened.store, head->number)) return *lost;
  opened.head = *head;
  const auto inside = opened.store->read_identity();
  if (!inside && !*identity) return damage("nothing says which store this is", folder.path());
  opened.identity = inside ? *inside : **identity;
  if (*identity && (*identity)->store == opened.identity.store)
    opened.identity.era = std::max(opened.identity.era, (*identity)->era);
  return opened;
}

}  // namespace cairn
