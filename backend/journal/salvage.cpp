// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/salvage.hpp"

#include <rocksdb/sst_file_reader.h>

#include "cairn/core/bytes.hpp"
#include "cairn/journal/log_tail.hpp"
#include "cairn/journal/record.hpp"

namespace cairn {
namespace {

using rocksdb::IOOptions;
using rocksdb::Status;
using rocksdb::WriteBatch;

constexpr std::size_t kBatchBytes = 1u << 20;

// Unsynced: the rebuilt store is flushed before it is used.
Status pass_on(Store& fresh, WriteBatch& batch, std::size_t at_least) {
  if (batch.GetDataSize() < at_least) return Status::OK();
  const Status status = fresh.db().Write(rocksdb::WriteOptions(), &batch);
  batch.Clear();
  return status;
}

// Calls visit() at each entry that can be read. An iterator does not get past a broken block: it
// goes on at the next range of keys, of which there are 65536, by their first two bytes.
template <class Visit>
void for_each_readable(rocksdb::Iterator& it, const Visit& visit) {
  for (int range = 0; range < 1 << 16; ++range) {
    const char start[] = {static_cast<char>(range >> 8), static_cast<char>(range)};
    for (it.Seek({start, sizeof start}); it.Valid(); it.Next()) {
      const rocksdb::Slice key = it.key();
      if (key.size() >= sizeof start)
        range = static_cast<unsigned char>(key[0]) << 8 | static_cast<unsigned char>(key[1]);
      visit();
    }
    if (it.status().ok()) return;
  }
}

Status copy_payloads(Store& remains, Store& fresh, std::uint64_t& kept) {
  WriteBatch batch;
  Status status;
  const std::unique_ptr<rocksdb::Iterator> it(
      remains.db().NewIterator(rocksdb::ReadOptions(), remains.payloads()));
  for_each_readable(*it, [&] {
    if (it->key().size() != sizeof(ContentHash)) return;
    fresh.put_payload(batch, ByteReader(it->key().ToStringView()).hash(),
                      it->value().ToStringView());
    ++kept;
    if (status.ok()) status = pass_on(fresh, batch, kBatchBytes);
  });
  return status.ok() ? pass_on(fresh, batch, 0) : status;
}

// Collects what the files of a store hold, without its MANIFEST: a repair by RocksDB refuses stores
// in which tables overlap, as they do when logs are turned into tables. Records never change and
// payloads are named by their hash, so the order of files does not matter for them.
class Gathering : public WriteBatch::Handler {
 public:
  explicit Gathering(Store& into) : into_(into) {}

  void take_table(const std::string& file) {
    rocksdb::Options options;
    options.env = into_.env();
    rocksdb::SstFileReader table(options);
    if (!table.Open(file).ok()) return;
    const std::unique_ptr<rocksdb::Iterator> it(table.NewIterator(rocksdb::ReadOptions()));
    for_each_readable(*it, [&] { keep(it->key(), it->value()); });
  }

  void take_log(std::string_view bytes) {
    for_each_write(bytes, [&](std::string_view write) {
      WriteBatch(std::string(write)).Iterate(this).PermitUncheckedError();
    });
  }

  // RocksDB's blob files: a header of 30 bytes, then {key size u64, value size u64, expiration u64,
  // two checksums u32, key, value}.
  void take_blobs(std::string_view bytes) {
    constexpr std::size_t kFileHeader = 30;
    ByteReader from(bytes);
    (void)from.raw(kFileHeader);
    while (from.ok()) {
      const auto key_size = from.integer<std::uint64_t>();
      const auto value_size = from.integer<std::uint64_t>();
      (void)from.raw(sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t));
      const std::string_view key = from.raw(key_size);
      const std::string_view value = from.raw(value_size);
      if (from.ok()) keep(slice(key), slice(value));
    }
  }

  [[nodiscard]] bool finish() { return sound_ && pass_on(into_, batch_, 0).ok(); }

 private:
  void keep(const rocksdb::Slice& key, const rocksdb::Slice& value) {
    if (Store::belongs_to_records(key)) {
      batch_.Put(key, value);
    } else if (const ContentHash hash = content_hash(value.ToStringView()); key == slice(hash)) {
      into_.put_payload(batch_, hash, value.ToStringView());
    } else {
      return;
    }
    sound_ = sound_ && pass_on(into_, batch_, kBatchBytes).ok();
  }

  Status PutCF(std::uint32_t, const rocksdb::Slice& key, const rocksdb::Slice& value) override {
    keep(key, value);
    return Status::OK();
  }
  // Payloads that were collected come back; the next collection takes them again.
  Status DeleteCF(std::uint32_t, const rocksdb::Slice&) override { return Status::OK(); }

  Store& into_;
  WriteBatch batch_;
  bool sound_ = true;
};

}  // namespace

std::uint64_t last_record_of_table(Store& store, const std::string& file) {
  if (!file.ends_with(".sst")) return 0;
  rocksdb::Options options;
  options.env = store.env();
  rocksdb::SstFileReader table(options);
  if (!table.Open(file).ok()) return 0;
  const std::unique_ptr<rocksdb::Iterator> it(table.NewIterator(rocksdb::ReadOptions()));
  it->SeekToLast();
  return it->Valid() ? Store::number_in_key(it->key()) : 0;
}

std::unique_ptr<Store> gather_remains(const DataFolder& folder, const std::string& name,
                                      const Store::Settings& settings) {
  std::unique_ptr<Store> gathered;
  if (!folder.has(name)) return gathered;
  const Status status = Store::open(folder.path(kGatheringFolder), folder.files(),
                                    Store::Mode::kCreate, settings, gathered);
  if (!status.ok()) return nullptr;
  Gathering gathering(*gathered);
  std::vector<std::string> files = folder.list(name);
  for (const std::string& file : files) {
    if (file.ends_with(".sst")) gathering.take_table(folder.path(name) + '/' + file);
  }
  for (const std::string& file : files) {
    const bool blobs = file.ends_with(".blob");
    if (!blobs && !file.ends_with(".log")) continue;
    const std::optional<std::string> bytes = folder.read(name + '/' + file);
    if (bytes) blobs ? gathering.take_blobs(*bytes) : gathering.take_log(*bytes);
  }
  return gathering.finish() ? std::move(gathered) : nullptr;
}

Status copy_good_part(Store& remains, Store& fresh, OpenReport::Damage& damage) {
  WriteBatch batch;
  Status status;
  const Store::Walk walk = remains.walk({}, [&](std::string_view bytes) -> Result<void> {
    const Result<Record> record = decode_record(bytes);
    if (!record) return record.error();
    batch.Put(Store::record_key(record->number), slice(bytes));
    status = pass_on(fresh, batch, kBatchBytes);
    if (!status.ok()) return storage_error(status, fresh.folder());
    return {};
  });
  if (status.ok()) status = pass_on(fresh, batch, 0);
  if (!status.ok()) return status;
  damage.kept = walk.last.number;
  if (walk.problem) damage.what += "; " + walk.problem->to_string();
  return copy_payloads(remains, fresh, damage.payloads);
}

}  // namespace cairn
