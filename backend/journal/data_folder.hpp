// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/file_system.h>
#include <rocksdb/status.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cairn/core/result.hpp"

namespace cairn {

/// Who a store is; kept beside it, so that it outlives the store's damage.
struct StoreIdentity {
  std::uint64_t store = 0;
  std::uint32_t era = 0;
};

/// A failed file operation or a broken file, in Cairn's terms.
Error storage_error(const rocksdb::Status& status, const std::string& place);

/// The one seam through which a data folder is touched (only its lock is taken beside it). Every
/// change is on disk when the call returns.
class DataFolder {
 public:
  DataFolder(std::string folder, std::shared_ptr<rocksdb::FileSystem> files);

  [[nodiscard]] const std::string& path() const { return folder_; }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + '/' + name; }
  [[nodiscard]] const std::shared_ptr<rocksdb::FileSystem>& files() const { return files_; }
  [[nodiscard]] bool has(const std::string& name) const;
  /// Names in a folder here, sorted; none where there is no such folder.
  [[nodiscard]] std::vector<std::string> list(const std::string& name) const;

  Result<void> create(const std::string& name) const;                           ///< a folder
  Result<void> write(const std::string& name, const std::string& bytes) const;  ///< whole or not
  [[nodiscard]] std::optional<std::string> read(const std::string& name) const;
  Result<void> rename(const std::string& from, const std::string& to) const;
  Result<void> remove(const std::string& name) const;         ///< a file
  Result<void> remove_folder(const std::string& name) const;  ///< with all that is in it

  /// Nothing where the file STORE is absent or unreadable; an error where a newer Cairn wrote it.
  [[nodiscard]] Result<std::optional<StoreIdentity>> read_identity() const;
  Result<void> write_identity(const StoreIdentity& identity) const;

 private:
  Result<void> sync_folder(const std::string& folder) const;

  std::string folder_;
  std::shared_ptr<rocksdb::FileSystem> files_;
};

/// One process, and one journal in it, per data folder. Freed by the kernel when a process dies.
class FolderLock {
 public:
  /// An error that names the holder where there is one.
  static Result<std::unique_ptr<FolderLock>> take(const std::string& folder);
  /// Keeps writers out, and lets other readers in. Writes nothing: where nobody ever locked the
  /// folder (a copy on read-only media), nothing is locked.
  static Result<std::unique_ptr<FolderLock>> take_for_reading(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace cairn
