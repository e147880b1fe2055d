// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/journal.hpp"

#include <rocksdb/file_system.h>

#include <algorithm>

#include "cairn/journal/recovery.hpp"
#include "cairn/journal/snapshots.hpp"

namespace cairn {
namespace {

std::string record_place(const Store& store, std::uint64_t number) {
  return store.folder() + ": record " + std::to_string(number);
}

Result<Record> decode_stored(const Store& store, std::uint64_t number, std::string_view bytes) {
  Result<Record> record = decode_record(bytes);
  if (!record) {
    const Error& error = record.error();
    return Error{error.code, error.message, record_place(store, number) + ", " + error.place};
  }
  return record;
}

}  // namespace

Result<std::unique_ptr<Journal>> Journal::open(const std::string& folder,
                                               const JournalOptions& options) {
  std::unique_ptr<Journal> journal(new Journal);
  journal->options_ = options;
  if (!options.file_system) journal->options_.file_system = rocksdb::FileSystem::Default();
  journal->folder_ = std::make_unique<DataFolder>(folder, journal->options_.file_system);
  const Result<void> opened =
      options.read_only ? journal->open_for_reading() : journal->open_for_writing();
  if (!opened) return opened.error();
  return journal;
}

Result<void> Journal::open_for_writing() {
  const std::string& folder = folder_->path();
  const rocksdb::Status made =
      options_.file_system->CreateDirIfMissing(folder, rocksdb::IOOptions(), nullptr);
  if (!made.ok()) return storage_error(made, folder);
  Result<std::unique_ptr<FolderLock>> lock = FolderLock::take(folder);
  if (!lock) return lock.error();
  lock_ = std::move(*lock);
  Result<OpenedStore> opened = open_store(*folder_, options_);
  if (!opened) return opened.error();
  take(std::move(*opened));
  return {};
}

Result<void> Journal::open_for_reading() {
  Result<std::unique_ptr<FolderLock>> lock = FolderLock::take_for_reading(folder_->path());
  if (!lock) return lock.error();
  lock_ = std::move(*lock);
  Result<OpenedStore> opened = open_store_for_reading(*folder_, options_);
  if (!opened) return opened.error();
  take(std::move(*opened));
  failure_ = Error{ErrorCode::kUsage, "the journal was opened for reading only", folder_->path()};
  return {};
}

void Journal::take(OpenedStore opened) {
  store_ = std::move(opened.store);
  report_ = std::move(opened.report);
  head_ = {{opened.identity.store, opened.identity.era, opened.head.number}, opened.head.hash};
}

Journal::~Journal() = default;

JournalHead Journal::head() const {
  const std::lock_guard lock(mutex_);
  return head_;
}

bool Journal::failed() const {
  const std::lock_guard lock(mutex_);
  return failure_.has_value();
}

Result<void> Journal::check_usable() const {
  const std::lock_guard lock(mutex_);
  if (failure_) return *failure_;
  return {};
}

Error Journal::fail(Error error) {
  error.message += "; the journal takes nothing more until it is opened anew";
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = std::move(error);
  return *failure_;
}

Result<Revision> Journal::append(std::span<const RecordBody> records) {
  const std::lock_guard one_at_a_time(append_mutex_);
  if (Result<void> usable = check_usable(); !usable) return usable.error();
  if (space() == DiskSpace::kFull) {
    return Error{ErrorCode::kInternal, "storage full: under 2 % of the disk is free",
                 folder_->path()};
  }
  JournalHead next = head();
  rocksdb::WriteBatch batch;
  for (const RecordBody& body : records) {
    ++next.revision.number;
    const std::string bytes =
        encode_record(next.revision.number, next.revision.era, body, next.chain);
    next.chain = chain_in(bytes);
    batch.Put(Store::record_key(next.revision.number), bytes);
  }
  const rocksdb::Status status = store_->write(batch);
  if (!status.ok()) return fail(storage_error(status, store_->folder()));
  const std::lock_guard lock(mutex_);
  head_ = next;
  return next.revision;
}

Result<Record> Journal::read(std::uint64_t number) const {
  Result<std::string> bytes = store_->read_record(number);
  if (!bytes) return bytes.error();
  return decode_stored(*store_, number, *bytes);
}

Result<void> Journal::for_each(std::uint64_t from,
                               const std::function<Result<void>(const Record&)>& visit) const {
  const std::uint64_t last = head().revision.number;
  ChainPoint before{from > 0 ? from - 1 : 0, {}};
  if (before.number >= last) return {};
  if (before.number > 0) {
    const Result<std::string> bytes = store_->read_record(before.number);
    if (!bytes) return bytes.error();
    before.hash = chain_in(*bytes);
  }
  std::uint64_t number = before.number;
  const Error past_the_head{};
  bool ended = false;
  const Store::Walk walk = store_->walk(before, [&](std::string_view bytes) -> Result<void> {
    ended = ++number > last;
    if (ended) return past_the_head;
    const Result<Record> record = decode_stored(*store_, number, bytes);
    if (!record) return record.error();
    return visit(*record);
  });
  if (walk.problem && !ended) return *walk.problem;
  return {};
}

Result<void> Journal::verify() const {
  const JournalHead head_now = head();
  const rocksdb::Status blocks = store_->db().VerifyChecksum();
  if (!blocks.ok()) return storage_error(blocks, store_->folder());
  std::uint64_t last = 0;
  ContentHash chain{};
  const Result<void> records = for_each(1, [&](const Record& record) -> Result<void> {
    last = record.number;
    chain = record.chain;
    return {};
  });
  if (!records) return records;
  if (last < head_now.revision.number ||
      (last == head_now.revision.number && chain != head_now.chain)) {
    return Error{ErrorCode::kBadInput, "the chain does not lead to the head",
                 record_place(*store_, last)};
  }
  Result<void> flaw;
  const Result<void> payloads =
      store_->walk_payloads([&](const ContentHash& hash, std::string_view bytes) {
        if (content_hash(bytes) == hash) return true;
        flaw = Error{ErrorCode::kBadInput, "the bytes do not have this hash",
                     store_->folder() + ": payload " + to_string(hash)};
        return false;
      });
  return payloads ? flaw : payloads;
}

Result<void> Journal::raise_era(std::uint32_t above) {
  const std::lock_guard one_at_a_time(append_mutex_);
  if (Result<void> usable = check_usable(); !usable) return usable;
  const Revision now = head().revision;
  const StoreIdentity identity{now.store, std::max(now.era, above) + 1};
  const rocksdb::Status status = store_->write_identity(identity);
  if (!status.ok()) return fail(storage_error(status, store_->folder()));
  if (Result<void> written = folder_->write_identity(identity); !written)
    return fail(written.error());
  const std::lock_guard lock(mutex_);
  head_.revision.era = identity.era;
  return {};
}

std::filesystem::space_info Journal::measure_space() const {
  if (options_.measure_space) return options_.measure_space(folder_->path());
  std::error_code failed;
  const std::filesystem::space_info info = std::filesystem::space(folder_->path(), failed);
  return failed ? std::filesystem::space_info{} : info;
}

std::uint64_t Journal::free_bytes() const { return measure_space().available; }

DiskSpace Journal::space() const {
  const std::filesystem::space_info info = measure_space();
  if (info.capacity == 0) return DiskSpace::kPlenty;
  const double free = static_cast<double>(info.available) / static_cast<double>(info.capacity);
  return free < 0.02 ? DiskSpace::kFull : free < 0.10 ? DiskSpace::kLow : DiskSpace::kPlenty;
}

Result<void> Journal::write_snapshot(std::uint64_t number, std::string_view bytes) {
  const Result<std::string> record = store_->read_record(number);
  if (!record) return record.error();
  return write_snapshot_file(*folder_, *store_, {number, chain_in(*record)}, bytes);
}

std::optional<Journal::Snapshot> Journal::newest_snapshot() const {
  std::optional<StoredSnapshot> stored = read_newest_snapshot(*folder_, *store_);
  if (!stored) return std::nullopt;
  return Snapshot{stored->at.number, std::move(stored->bytes)};
}

}  // namespace cairn
