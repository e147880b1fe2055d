// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/store.hpp"

#include <rocksdb/cache.h>
#include <rocksdb/table.h>

#include <algorithm>

#include "cairn/core/bytes.hpp"
#include "cairn/core/wall_clock.hpp"
#include "cairn/journal/record.hpp"

namespace cairn {
namespace {

using rocksdb::ColumnFamilyDescriptor;
using rocksdb::Status;

constexpr char kPayloads[] = "payloads";
constexpr char kIdentityKey[] = "m";
// In the column family of payloads, beside the identity; part of format 1.
constexpr char kPayloadMarkKey[] = "";
constexpr char kPayloadTimeKey = 't';
constexpr std::size_t kSmallestBlobBytes = 4096;
// Of blocks that were read. By default it would be 8 MB a family, filled in the course of days:
// operators read a record here and there, and nobody the same again.
constexpr std::size_t kCacheBytes = 1u << 20;

bool changes_nothing(Store::Mode mode) {
  return mode == Store::Mode::kInspect || mode == Store::Mode::kInspectCut;
}

// RocksDB's own log file, which nobody asked for where nothing may change.
class NoLog : public rocksdb::Logger {
 public:
  using Logger::Logv;
  void Logv(const char* /*format*/, va_list /*arguments*/) override {}
};

rocksdb::DBOptions database_options(rocksdb::Env* env, Store::Mode mode) {
  using Recovery = rocksdb::WALRecoveryMode;
  rocksdb::DBOptions options;
  options.env = env;
  options.create_if_missing = mode == Store::Mode::kCreate;
  options.error_if_exists = mode == Store::Mode::kCreate;
  options.create_missing_column_families = mode == Store::Mode::kCreate;
  options.track_and_verify_wals_in_manifest = true;
  const bool strict = mode == Store::Mode::kStrict || mode == Store::Mode::kInspect;
  options.wal_recovery_mode =
      strict ? Recovery::kAbsoluteConsistency : Recovery::kPointInTimeRecovery;
  if (changes_nothing(mode)) options.info_log = std::make_shared<NoLog>();
  options.max_total_wal_size = 256u << 20;
  options.info_log_level = rocksdb::WARN_LEVEL;
  options.keep_log_file_num = 3;
  // Tables leave for the disk while they are written, not at once at their end, and by threads that
  // leave the processors to others: who waits for a sync of the log waits for nothing else.
  options.bytes_per_sync = 1u << 20;
  for (const auto pool : {rocksdb::Env::Priority::LOW, rocksdb::Env::Priority::HIGH})
    (void)env->LowerThreadPoolCPUPriority(pool, rocksdb::CpuPriority::kLow);
  options.stats_dump_period_sec = 0;
  options.stats_persist_period_sec = 0;
  return options;
}

rocksdb::ColumnFamilyOptions record_options(const Store::Settings& settings) {
  rocksdb::ColumnFamilyOptions options;
  options.write_buffer_size = settings.write_buffer_bytes;
  options.compression = rocksdb::kNoCompression;
  rocksdb::BlockBasedTableOptions table;
  table.block_cache = rocksdb::NewLRUCache(kCacheBytes);
  options.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
  return options;
}

rocksdb::ColumnFamilyOptions payload_options(const Store::Settings& settings) {
  rocksdb::ColumnFamilyOptions options = record_options(settings);
  options.enable_blob_files = true;
  options.min_blob_size = kSmallestBlobBytes;
  options.enable_blob_garbage_collection = true;
  return options;
}

rocksdb::WriteOptions synced() {
  rocksdb::WriteOptions options;
  options.sync = true;
  return options;
}

bool is_record(const rocksdb::Slice& key) { return key.size() == 9 && key[0] == 'r'; }

std::string payload_time_key(const ContentHash& hash) {
  return kPayloadTimeKey + slice(hash).ToString();
}

std::string_view view(const rocksdb::Slice& slice) { return {slice.data(), slice.size()}; }

}  // namespace

rocksdb::Slice slice(std::string_view bytes) { return {bytes.data(), bytes.size()}; }
rocksdb::Slice slice(const ContentHash& hash) {
  return {reinterpret_cast<const char*>(hash.data()), hash.size()};
}

Status Store::open(const std::string& folder, const std::shared_ptr<rocksdb::FileSystem>& files,
                   Mode mode, const Settings& settings, std::unique_ptr<Store>& store) {
  std::unique_ptr<Store> opened(new Store);
  opened->folder_ = folder;
  opened->env_ = rocksdb::NewCompositeEnv(files);
  const rocksdb::DBOptions options = database_options(opened->env_.get(), mode);
  std::vector<ColumnFamilyDescriptor> families{
      {rocksdb::kDefaultColumnFamilyName, record_options(settings)},
      {kPayloads, payload_options(settings)}};
  if (changes_nothing(mode)) {
    std::vector<std::string> names;
    if (const Status s = rocksdb::DB::ListColumnFamilies(options, folder, &names); !s.ok())
      return s;
    if (std::find(names.begin(), names.end(), kPayloads) == names.end()) families.pop_back();
  }
  std::vector<rocksdb::ColumnFamilyHandle*> handles;
  rocksdb::DB* db = nullptr;
  const Status status = changes_nothing(mode)
                            ? rocksdb::DB::OpenForReadOnly(options, folder, families, &handles, &db)
                            : rocksdb::DB::Open(options, folder, families, &handles, &db);
  if (!status.ok()) return status;
  opened->db_.reset(db);
  opened->records_ = handles[0];
  if (handles.size() > 1) opened->payloads_ = handles[1];
  store = std::move(opened);
  return status;
}

Store::~Store() {
  if (payloads_) db_->DestroyColumnFamilyHandle(payloads_);
  if (records_) db_->DestroyColumnFamilyHandle(records_);
}

std::string Store::record_key(std::uint64_t number) {
  std::string key = "r";
  for (int shift = 56; shift >= 0; shift -= 8) key += static_cast<char>(number >> shift);
  return key;
}

std::uint64_t Store::number_in_key(const rocksdb::Slice& key) {
  std::uint64_t number = 0;
  for (std::size_t i = 1; is_record(key) && i < key.size(); ++i)
    number = number << 8 | static_cast<unsigned char>(key[i]);
  return number;
}

bool Store::belongs_to_records(const rocksdb::Slice& key) {
  return is_record(key) || key == kIdentityKey;
}

Status Store::write(rocksdb::WriteBatch& batch) { return db_->Write(synced(), &batch); }

Status Store::flush() { return db_->Flush(rocksdb::FlushOptions(), {records_, payloads_}); }

std::optional<StoreIdentity> Store::read_identity() {
  std::string bytes;
  if (!db_->Get(rocksdb::ReadOptions(), records_, kIdentityKey, &bytes).ok()) return std::nullopt;
  ByteReader from(bytes);
  const StoreIdentity identity{from.integer<std::uint64_t>(), from.integer<std::uint32_t>()};
  if (!from.ok()) return std::nullopt;
  return identity;
}

Status Store::write_identity(const StoreIdentity& identity) {
  std::string bytes;
  ByteWriter to(bytes);
  to.integer(identity.store);
  to.integer(identity.era);
  rocksdb::WriteBatch batch;
  batch.Put(records_, kIdentityKey, bytes);
  batch.Put(payloads_, kPayloadMarkKey, "");
  return write(batch);
}

Result<ChainPoint> Store::read_head() {
  const std::unique_ptr<rocksdb::Iterator> it(db_->NewIterator(rocksdb::ReadOptions(), records_));
  it->SeekToLast();
  if (!it->status().ok()) return storage_error(it->status(), folder_);
  if (!it->Valid() || !is_record(it->key())) return ChainPoint{};
  return ChainPoint{number_in_key(it->key()), chain_in(view(it->value()))};
}

Result<std::string> Store::read_record(std::uint64_t number) {
  std::string bytes;
  const Status status = db_->Get(rocksdb::ReadOptions(), records_, record_key(number), &bytes);
  if (!status.ok()) {
    Error error = storage_error(status, folder_ + ": record " + std::to_string(number));
    if (status.IsNotFound()) error = {ErrorCode::kBadInput, "there is no such record", error.place};
    return error;
  }
  return bytes;
}

Store::Walk Store::walk(const ChainPoint& after,
                        const std::function<Result<void>(std::string_view)>& visit) {
  Walk walk{after};
  const auto problem = [&](std::string message) {
    walk.problem = Error{ErrorCode::kBadInput, std::move(message),
                         folder_ + ": record " + std::to_string(walk.last.number + 1)};
    return walk;
  };
  rocksdb::ReadOptions options;
  options.readahead_size = 1u << 20;
  options.fill_cache = false;
  const std::unique_ptr<rocksdb::Iterator> it(db_->NewIterator(options, records_));
  for (it->Seek(record_key(after.number + 1)); it->Valid() && is_record(it->key()); it->Next()) {
    const std::string_view bytes = view(it->value());
    const std::uint64_t number = number_in_key(it->key());
    if (number != walk.last.number + 1)
      return problem("is missing; the next one is " + std::to_string(number));
    const ContentHash chain = chain_after(walk.last.hash, bytes);
    if (chain != chain_in(bytes))
      return problem("its hash does not continue the chain: it or a record before it has changed");
    if (Result<void> visited = visit(bytes); !visited) {
      walk.problem = visited.error();
      return walk;
    }
    walk.last = {number, chain};
  }
  if (!it->status().ok()) return problem(it->status().ToString());
  return walk;
}

void Store::put_payload(rocksdb::WriteBatch& batch, const ContentHash& hash,
                        std::string_view bytes) {
  batch.Put(payloads_, slice(hash), slice(bytes));
  put_payload_time(batch, hash);
}

void Store::put_payload_time(rocksdb::WriteBatch& batch, const ContentHash& hash) {
  std::string now;
  ByteWriter(now).integer(wall_clock_ns());
  batch.Put(payloads_, payload_time_key(hash), now);
}

void Store::delete_payload(rocksdb::WriteBatch& batch, const ContentHash& hash) {
  batch.Delete(payloads_, slice(hash));
  forget_payload_time(batch, hash);
}

void Store::forget_payload_time(rocksdb::WriteBatch& batch, const ContentHash& hash) {
  batch.Delete(payloads_, payload_time_key(hash));
}

Result<void> Store::walk_payload_times(
    const std::function<void(const ContentHash&, std::int64_t)>& visit) {
  const std::unique_ptr<rocksdb::Iterator> it(db_->NewIterator(rocksdb::ReadOptions(), payloads_));
  const std::string prefix(1, kPayloadTimeKey);
  for (it->Seek(prefix); it->Valid() && it->key().starts_with(prefix); it->Next()) {
    if (it->key().size() != 1 + sizeof(ContentHash)) continue;  // a payload's hash may begin so
    std::string_view hash = view(it->key());
    hash.remove_prefix(1);
    visit(ByteReader(hash).hash(), ByteReader(view(it->value())).integer<std::int64_t>());
  }
  if (!it->status().ok()) return storage_error(it->status(), folder_ + ": payloads");
  return {};
}

Result<void> Store::walk_payloads(
    const std::function<bool(const ContentHash&, std::string_view)>& visit) {
  if (!payloads_) return {};
  const std::unique_ptr<rocksdb::Iterator> it(db_->NewIterator(rocksdb::ReadOptions(), payloads_));
  for (it->SeekToFirst(); it->Valid(); it->Next()) {
    if (it->key().size() != sizeof(ContentHash)) continue;
    if (!visit(ByteReader(view(it->key())).hash(), view(it->value()))) return {};
  }
  if (!it->status().ok()) return storage_error(it->status(), folder_ + ": payloads");
  return {};
}

}  // namespace cairn
