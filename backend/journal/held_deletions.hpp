// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/file_system.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace cairn {

/// What is appended to the name of a table that would have been overwritten.
inline constexpr char kKeptTable[] = ".kept.sst";

/// A file system that deletes and overwrites no table before it is told that the store is sound.
/// RocksDB deletes what its MANIFEST does not name when it opens a store; a MANIFEST that was cut
/// names too little.
class HeldDeletions : public rocksdb::FileSystemWrapper {
 public:
  explicit HeldDeletions(const std::shared_ptr<rocksdb::FileSystem>& files)
      : FileSystemWrapper(files) {}
  [[nodiscard]] const char* Name() const override { return "cairn.HeldDeletions"; }

  rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                               rocksdb::IODebugContext* debug) override {
    const std::lock_guard lock(mutex_);
    if (released_) return target()->DeleteFile(name, options, debug);
    held_.push_back(name);
    return rocksdb::IOStatus::OK();
  }
  rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                    std::unique_ptr<rocksdb::FSWritableFile>* file,
                                    rocksdb::IODebugContext* debug) override {
    const std::lock_guard lock(mutex_);
    if (!released_ && name.ends_with(".sst") &&
        target()->FileExists(name, options.io_options, debug).ok()) {
      const std::string kept = name + kKeptTable;
      if (const auto s = target()->RenameFile(name, kept, options.io_options, debug); !s.ok())
        return s;
      held_.push_back(kept);
    }
    return target()->NewWritableFile(name, options, file, debug);
  }
  [[nodiscard]] std::vector<std::string> held() const {
    const std::lock_guard lock(mutex_);
    return held_;
  }
  /// Deletes what was held, and from now on at once.
  void release() {
    const std::lock_guard lock(mutex_);
    released_ = true;
    for (const std::string& name : held_)
      target()->DeleteFile(name, rocksdb::IOOptions(), nullptr).PermitUncheckedError();
    held_.clear();
  }

 private:
  mutable std::mutex mutex_;
  bool released_ = false;
  std::vector<std::string> held_;
};

}  // namespace cairn
