// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/file_system.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace cairn::test {

/// One thing that was done to the files of a folder.
struct DiskEvent {
  enum class Kind { kCreate, kAppend, kTruncate, kSync, kRename, kDelete, kLink, kSyncFolder };
  Kind kind = Kind::kCreate;
  std::string path;        ///< of a file or, for kSyncFolder, a folder
  std::string other;       ///< kRename, kLink: the new name
  std::string data;        ///< kAppend
  std::uint64_t size = 0;  ///< kTruncate
};

/// Passes everything on to the machine's file system and keeps what happened, in order.
class RecordingFileSystem : public rocksdb::FileSystemWrapper {
 public:
  /// With `syncs_do_nothing`, a sync reports success without having happened.
  explicit RecordingFileSystem(bool syncs_do_nothing);

  [[nodiscard]] const char* Name() const override { return "RecordingFileSystem"; }
  [[nodiscard]] std::size_t event_count() const;
  [[nodiscard]] std::vector<DiskEvent> events() const;
  void add(DiskEvent event);
  [[nodiscard]] bool syncs_do_nothing() const { return syncs_do_nothing_; }

  rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                    std::unique_ptr<rocksdb::FSWritableFile>* file,
                                    rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus ReopenWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                       std::unique_ptr<rocksdb::FSWritableFile>* file,
                                       rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus ReuseWritableFile(const std::string& name, const std::string& old_name,
                                      const rocksdb::FileOptions& options,
                                      std::unique_ptr<rocksdb::FSWritableFile>* file,
                                      rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus NewDirectory(const std::string& name, const rocksdb::IOOptions& options,
                                 std::unique_ptr<rocksdb::FSDirectory>* folder,
                                 rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                               rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus RenameFile(const std::string& from, const std::string& to,
                               const rocksdb::IOOptions& options,
                               rocksdb::IODebugContext* debug) override;
  rocksdb::IOStatus LinkFile(const std::string& from, const std::string& to,
                             const rocksdb::IOOptions& options,
                             rocksdb::IODebugContext* debug) override;

 private:
  const bool syncs_do_nothing_;
  mutable std::mutex mutex_;
  std::vector<DiskEvent> events_;
};

/// The machine's file system with syncs that do nothing: to open rebuilt disks quickly.
std::shared_ptr<rocksdb::FileSystem> unsynced_file_system();

/// What a disk holds while events happen to it, and what it may hold when the power goes. Contents
/// are kept by sync of the file; names (creation, renaming, deletion) by sync of the folder, and
/// otherwise in their order of time, up to a point, as file systems with a journal do it.
class DiskModel {
 public:
  void apply(const DiskEvent& event);
  /// Writes under `folder` what is left of everything under `root` after a power loss now: a random
  /// number of the unsynced changes of names, and of each file's unsynced bytes random sectors.
  void write_after_power_loss(const std::string& root, const std::string& folder,
                              std::mt19937& random) const;

 private:
  struct File {
    std::string bytes;
    std::size_t synced = 0;  // the first so many bytes are on disk
  };
  using Names = std::map<std::string, std::shared_ptr<File>>;
  static void rename_in(Names& names, const DiskEvent& event);

  Names names_;    // as the process sees them
  Names durable_;  // as they are on disk for sure
  struct Change {
    DiskEvent event;
    std::shared_ptr<File> file;  // kCreate, kLink
  };
  static void change_names(Names& names, const Change& change);
  std::vector<Change> unsynced_;  // changes of names since
};

}  // namespace cairn::test
