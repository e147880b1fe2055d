// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/db.h>
#include <rocksdb/write_batch.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "cairn/core/content_hash.hpp"
#include "cairn/core/result.hpp"
#include "cairn/journal/data_folder.hpp"

namespace cairn {

/// A position in the journal: a record's number and the chain hash up to it. 0 and zeros: empty.
struct ChainPoint {
  std::uint64_t number = 0;
  ContentHash hash{};

  friend bool operator==(const ChainPoint&, const ChainPoint&) = default;
};

/// The RocksDB store of a data folder. Records and identity are in the default column family
/// ("m" -> identity, "r" + number, big-endian -> encoded record), payloads in one of their own
/// (content hash -> bytes, large ones in blob files; "t" + hash -> when it came).
class Store {
 public:
  enum class Mode {
    kCreate,      ///< must not exist
    kStrict,      ///< any flaw is an error
    kCutTail,     ///< an incomplete last write is cut
    kInspect,     ///< any flaw is an error; changes nothing
    kInspectCut,  ///< as kInspect, but an incomplete last write is left out
  };
  struct Settings {
    std::size_t write_buffer_bytes = 64u << 20;
  };

  static rocksdb::Status open(const std::string& folder,
                              const std::shared_ptr<rocksdb::FileSystem>& files, Mode mode,
                              const Settings& settings, std::unique_ptr<Store>& store);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  static std::string record_key(std::uint64_t number);
  static std::uint64_t number_in_key(const rocksdb::Slice& key);  ///< 0: not a record's
  static bool belongs_to_records(const rocksdb::Slice& key);      ///< of a record or the identity
  rocksdb::Status write(rocksdb::WriteBatch& batch);              ///< durable when it returns
  rocksdb::Status flush();                                        ///< everything into tables

  std::optional<StoreIdentity> read_identity();
  rocksdb::Status write_identity(const StoreIdentity& identity);

  /// The last record's number and chain; {} for an empty store.
  Result<ChainPoint> read_head();
  Result<std::string> read_record(std::uint64_t number);
  /// Visits the bytes of all records after `after`, in order, checking numbers and chain. Gives the
  /// last good place; `problem` says why it is not the end, or that the visitor wanted to stop.
  struct Walk {
    ChainPoint last;
    std::optional<Error> problem{};
  };
  Walk walk(const ChainPoint& after, const std::function<Result<void>(std::string_view)>& visit);

  /// The payload, with the time at which it came: now.
  void put_payload(rocksdb::WriteBatch& batch, const ContentHash& hash, std::string_view bytes);
  void put_payload_time(rocksdb::WriteBatch& batch, const ContentHash& hash);
  void delete_payload(rocksdb::WriteBatch& batch, const ContentHash& hash);
  /// From here on it stays for ever.
  void forget_payload_time(rocksdb::WriteBatch& batch, const ContentHash& hash);
  /// Visits the times at which payloads came, nanoseconds since 1970.
  Result<void> walk_payload_times(
      const std::function<void(const ContentHash&, std::int64_t)>& visit);
  /// Visits payloads in order of hash. False from the visitor stops.
  Result<void> walk_payloads(
      const std::function<bool(const ContentHash&, std::string_view)>& visit);

  [[nodiscard]] rocksdb::DB& db() { return *db_; }
  /// Null in a damaged store that lost them.
  [[nodiscard]] rocksdb::ColumnFamilyHandle* payloads() { return payloads_; }
  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] rocksdb::Env* env() { return env_.get(); }

 private:
  Store() = default;

  std::string folder_;
  std::unique_ptr<rocksdb::Env> env_;
  std::unique_ptr<rocksdb::DB> db_;
  rocksdb::ColumnFamilyHandle* records_ = nullptr;
  rocksdb::ColumnFamilyHandle* payloads_ = nullptr;
};

rocksdb::Slice slice(std::string_view bytes);
rocksdb::Slice slice(const ContentHash& hash);

}  // namespace cairn
