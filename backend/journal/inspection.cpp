// SPDX-License-Identifier: BSD-3-Clause
// Opening for those who only look: what recovery.cpp mends is told here, and left as it is.
#include <rocksdb/file_system.h>

#include <algorithm>
#include <set>

#include "cairn/journal/log_tail.hpp"
#include "cairn/journal/recovery.hpp"
#include "cairn/journal/salvage.hpp"

namespace cairn {
namespace {

constexpr char kStore[] = "store";

using rocksdb::FSSequentialFile;
using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;

class ShortenedFile : public rocksdb::FSSequentialFileOwnerWrapper {
 public:
  ShortenedFile(std::unique_ptr<FSSequentialFile> file, std::uint64_t bytes)
      : FSSequentialFileOwnerWrapper(std::move(file)), left_(bytes) {}
  IOStatus Read(std::size_t size, const IOOptions& options, rocksdb::Slice* result, char* scratch,
                IODebugContext* debug) override {
    const std::size_t most = std::min<std::uint64_t>(size, left_);
    const IOStatus status = target()->Read(most, options, result, scratch, debug);
    if (status.ok()) left_ -= result->size();
    return status;
  }

 private:
  std::uint64_t left_;
};

// Shows the files as they are, but one of them without its torn end.
class WithoutTornEnd : public rocksdb::FileSystemWrapper {
 public:
  WithoutTornEnd(const std::shared_ptr<rocksdb::FileSystem>& files, std::string path,
                 std::uint64_t bytes)
      : FileSystemWrapper(files), path_(std::move(path)), bytes_(bytes) {}
  [[nodiscard]] const char* Name() const override { return "cairn.WithoutTornEnd"; }
  IOStatus NewSequentialFile(const std::string& name, const rocksdb::FileOptions& options,
                             std::unique_ptr<FSSequentialFile>* file,
                             IODebugContext* debug) override {
    const IOStatus status = target()->NewSequentialFile(name, options, file, debug);
    if (status.ok() && name == path_)
      *file = std::make_unique<ShortenedFile>(std::move(*file), bytes_);
    return status;
  }

 private:
  std::string path_;
  std::uint64_t bytes_;
};

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
  std::shared_ptr<rocksdb::FileSystem> files = folder.files();
  const auto open = [&](Store::Mode mode) {
    return Store::open(folder.path(kStore), files, mode, settings, opened.store);
  };
  rocksdb::Status status = open(Store::Mode::kInspect);
  if (status.IsCorruption()) {
    const LogInspection logs = inspect_logs(folder, kStore);
    if (logs.damage) return damage(*logs.damage, folder.path(kStore));
    const std::optional<TornFile> manifest = find_torn_manifest(folder, kStore);
    if (manifest) {
      files =
          std::make_shared<WithoutTornEnd>(files, folder.path(manifest->name), manifest->good_end);
      opened.report.cut_tail = manifest->what;
    }
    if (logs.torn_tail) opened.report.cut_tail = logs.torn_tail;
    if (opened.report.cut_tail)
      status = open(logs.torn_tail ? Store::Mode::kInspectCut : Store::Mode::kInspect);
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
