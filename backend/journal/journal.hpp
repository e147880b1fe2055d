// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"
#include "cairn/journal/record.hpp"

namespace rocksdb {
class FileSystem;
}

namespace cairn {

class DataFolder;
class FolderLock;
class Store;
struct OpenedStore;

struct JournalOptions {
  /// Every file operation goes through it (the lock apart). Null: the machine's file system.
  std::shared_ptr<rocksdb::FileSystem> file_system{};
  /// Measures the disk of a folder. Null: std::filesystem::space.
  std::function<std::filesystem::space_info(const std::string& folder)> measure_space{};
  /// Records kept in memory before they go into a table file, bytes.
  std::size_t write_buffer_bytes = 64u << 20;
  /// Change nothing in the folder, not even to mend it: damage is an error, and so is a folder that
  /// is no data folder. Others may read too, but nobody may write meanwhile. Nothing can be
  /// appended.
  bool read_only = false;
};

/// What opening found. Nothing in it: all is well.
struct OpenReport {
  struct Damage {
    std::string what;            ///< and where: file and byte, or record
    std::uint64_t kept = 0;      ///< records 1 to `kept` are served
    std::uint32_t era = 0;       ///< the new one
    std::string set_aside;       ///< the folder with the damaged store; empty: nothing was left
    std::uint64_t payloads = 0;  ///< how many could be kept
  };
  bool created = false;
  /// A last write that never finished, and so was never acknowledged, was cut off: file and byte.
  std::optional<std::string> cut_tail{};
  std::optional<Damage> damage{};
};

/// Where the journal ends.
struct JournalHead {
  Revision revision;
  ContentHash chain{};  ///< zeros for an empty journal

  friend bool operator==(const JournalHead&, const JournalHead&) = default;
};

enum class DiskSpace { kPlenty, kLow, kFull };  ///< kLow: under 10 %, kFull: under 2 % is free

/// All that Cairn knows, as a sequence of records on disk. What append() has returned survives
/// kill and power loss. Thread-safe; appends wait for each other.
class Journal {
 public:
  /// Opens the journal in `folder`, or makes one. One journal per folder at a time. Damage is no
  /// error: the good beginning is served, the rest set aside, and open_report() tells. (Otherwise
  /// with `read_only`.)
  static Result<std::unique_ptr<Journal>> open(const std::string& folder,
                                               const JournalOptions& options = {});
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const OpenReport& open_report() const { return report_; }
  [[nodiscard]] JournalHead head() const;

  /// Adds records, all or none, and waits until they are on disk. Gives the last one's revision.
  /// On a full disk: an error, try again later. Any other failure is for good: each later append
  /// fails too, until the journal is opened anew (what the failed write left may then be there).
  Result<Revision> append(std::span<const RecordBody> records);
  [[nodiscard]] bool failed() const;

  /// The record with this number (1, 2, ...), its bytes verified by the store, its chain not.
  [[nodiscard]] Result<Record> read(std::uint64_t number) const;
  /// Visits records `from`, `from` + 1, ... to the head as of the call, checking the chain between
  /// them. An error from the visitor ends it and is returned.
  Result<void> for_each(std::uint64_t from,
                        const std::function<Result<void>(const Record&)>& visit) const;
  /// Checks every block of the store, every record against the chain, every payload against its
  /// hash. The error says where the first flaw is.
  [[nodiscard]] Result<void> verify() const;
  /// A new era, after this one and after `above`: for when clients hold receipts above the head.
  /// Records lost are named by the old.
  Result<void> raise_era(std::uint32_t above = 0);

  /// Stores bytes under their content hash, durably. Those that are stored already count as new.
  Result<ContentHash> put_payload(std::string_view bytes);
  [[nodiscard]] bool has_payload(const ContentHash& hash) const;
  [[nodiscard]] Result<std::string> read_payload(const ContentHash& hash) const;
  /// Deletes payloads that came before this time (nanoseconds since 1970) and that no accepted
  /// transaction names; gives their number. Reads all records if there are old ones of which it is
  /// not known that they are named, and ends with an error once `go_on` says no. Not beside
  /// put_payload.
  Result<std::uint64_t> collect_payloads(std::int64_t before_ns,
                                         const std::function<bool()>& go_on);

  /// Stores the estimates after record `number`, so that a start need not replay what is before.
  /// The two newest are kept.
  Result<void> write_snapshot(std::uint64_t number, std::string_view bytes);
  struct Snapshot {
    std::uint64_t number = 0;
    std::string bytes;
  };
  /// The newest one that is whole and belongs to this journal.
  [[nodiscard]] std::optional<Snapshot> newest_snapshot() const;

  /// Adds a copy of the journal as it is now to the backups in `folder` (made if absent), while
  /// others append. Unchanged files are shared between backups.
  Result<void> backup(const std::string& folder) const;
  /// Makes a data folder from the newest backup. Its era is raised: what was appended after the
  /// backup had the same numbers. `folder` must be absent or empty.
  static Result<void> restore(const std::string& backup_folder, const std::string& folder);

  /// Of the disk under the folder, measured now.
  [[nodiscard]] DiskSpace space() const;
  [[nodiscard]] std::uint64_t free_bytes() const;  ///< of it, for this process

 private:
  Journal() = default;
  Result<void> open_for_reading();
  Result<void> open_for_writing();
  void take(OpenedStore opened);
  [[nodiscard]] std::filesystem::space_info measure_space() const;
  Result<void> check_usable() const;  // the failure, where there was one
  Error fail(Error error);            // keeps it

  JournalOptions options_;
  std::unique_ptr<FolderLock> lock_;
  std::unique_ptr<DataFolder> folder_;
  std::unique_ptr<Store> store_;
  OpenReport report_;
  std::mutex append_mutex_;   // held while the head is being moved
  mutable std::mutex mutex_;  // guards what follows; never held while waiting for the disk
  JournalHead head_;
  std::optional<Error> failure_;
};

}  // namespace cairn
