// SPDX-License-Identifier: BSD-3-Clause
// Backups of a Journal, and journals made from them.
#include <rocksdb/utilities/backup_engine.h>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {
namespace {

rocksdb::BackupEngineOptions backup_options(const std::string& folder) {
  rocksdb::BackupEngineOptions options(folder);
  options.share_files_with_checksum = true;
  return options;
}

// Not under its final name before it is whole (see recovery.cpp).
constexpr char kUnfinished[] = "rebuilding";

Result<void> restore_store(const std::string& backup_folder, const DataFolder& target) {
  rocksdb::BackupEngineReadOnly* opened = nullptr;
  rocksdb::Status status = rocksdb::BackupEngineReadOnly::Open(backup_options(backup_folder),
                                                               rocksdb::Env::Default(), &opened);
  const std::unique_ptr<rocksdb::BackupEngineReadOnly> engine(opened);
  if (!status.ok()) return storage_error(status, backup_folder);
  const std::string store_folder = target.path(kUnfinished);
  std::unique_ptr<Store> store;
  status = target.files()->CreateDirIfMissing(target.path(), rocksdb::IOOptions(), nullptr);
  if (status.ok()) status = engine->RestoreDBFromLatestBackup(store_folder, store_folder);
  if (status.ok())
    status = Store::open(store_folder, target.files(), Store::Mode::kCutTail, {}, store);
  if (!status.ok()) return storage_error(status, backup_folder);
  std::optional<StoreIdentity> identity = store->read_identity();
  if (!identity) return Error{ErrorCode::kBadInput, "is not a backup of a journal", backup_folder};
  ++identity->era;
  status = store->write_identity(*identity);
  store.reset();
  if (!status.ok()) return storage_error(status, store_folder);
  if (Result<void> named = target.rename(kUnfinished, "store"); !named) return named;
  return target.write_identity(*identity);
}

}  // namespace

Result<void> Journal::backup(const std::string& folder) const {
  rocksdb::BackupEngine* opened = nullptr;
  rocksdb::IOStatus status =
      rocksdb::BackupEngine::Open(backup_options(folder), store_->env(), &opened);
  const std::unique_ptr<rocksdb::BackupEngine> engine(opened);
  if (status.ok()) status = engine->CreateNewBackup(&store_->db());
  if (!status.ok()) return storage_error(status, folder);
  return {};
}

Result<void> Journal::restore(const std::string& backup_folder, const std::string& folder) {
  const DataFolder target(folder, rocksdb::FileSystem::Default());
  if (!target.list("").empty()) {
    return Error{ErrorCode::kUsage, "is not empty; restore into a new folder", folder};
  }
  if (!DataFolder(backup_folder, target.files()).has("meta"))
    return Error{ErrorCode::kBadInput, "is no folder of backups", backup_folder};
  const bool was_there = target.has("");
  Result<void> restored = restore_store(backup_folder, target);
  if (restored) return restored;
  // Nothing half-made stays, which a daemon would take for a new folder.
  if (target.has(kUnfinished)) (void)target.remove_folder(kUnfinished);
  if (!was_there) (void)target.files()->DeleteDir(folder, rocksdb::IOOptions(), nullptr);
  return restored;
}

}  // namespace cairn
