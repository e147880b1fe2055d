// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/salvage.hpp"

#include <rocksdb/sst_file_reader.h>

#include "cairn/journal/held_deletions.hpp"
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

// A repair renames and deletes files, but never writes into one: links keep the original whole.
bool link_store(const DataFolder& folder, const std::string& name) {
  if (!folder.create(kRepairFolder)) return false;
  for (const std::string& file : folder.list(name)) {
    if (file == "LOCK" || file.rfind("MANIFEST", 0) == 0 || file == "CURRENT") continue;
    std::string target = folder.path(kRepairFolder) + '/' + file;
    if (file.ends_with(kKeptTable))  // under a number that no other table has
      target = folder.path(kRepairFolder) + "/9" + file.substr(0, file.find('.')) + ".sst";
    rocksdb::FileSystem& files = *folder.files();
    Status status = files.LinkFile(folder.path(name) + '/' + file, target, IOOptions(), nullptr);
    if (!status.ok()) return false;
  }
  return true;
}

std::uint64_t records_in(Store& store) {
  return store.walk({}, [](std::string_view) -> Result<void> { return {}; }).last.number;
}

Status copy_payloads(Store& remains, Store& fresh, std::uint64_t& kept) {
  if (!remains.payloads()) return Status::OK();
  WriteBatch batch;
  // An iterator does not get past a broken block: it goes on at the next range of hashes, of which
  // there are 65536, by their first two bytes.
  for (int range = 0; range < 1 << 16; ++range) {
    const char start[] = {static_cast<char>(range >> 8), static_cast<char>(range)};
    const std::unique_ptr<rocksdb::Iterator> it(
        remains.db().NewIterator(rocksdb::ReadOptions(), remains.payloads()));
    for (it->Seek({start, sizeof start}); it->Valid(); it->Next()) {
      const rocksdb::Slice key = it->key();
      range = static_cast<unsigned char>(key[0]) << 8 | static_cast<unsigned char>(key[1]);
      const std::string_view value(it->value().data(), it->value().size());
      if (key.compare(slice(content_hash(value))) != 0) continue;
      batch.Put(fresh.payloads(), key, it->value());
      ++kept;
      if (const Status status = pass_on(fresh, batch, kBatchBytes); !status.ok()) return status;
    }
    if (it->status().ok()) break;
  }
  return pass_on(fresh, batch, 0);
}

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

std::unique_ptr<Store> open_remains(const DataFolder& folder, const std::string& name,
                                    const Store::Settings& settings) {
  std::unique_ptr<Store> as_told, repaired;
  if (!folder.has(name)) return as_told;
  const auto& files = folder.files();
  (void)Store::open(folder.path(name), files, Store::Mode::kReadOnly, settings, as_told);
  if (!link_store(folder, name) || !Store::repair(folder.path(kRepairFolder), files).ok() ||
      !Store::open(folder.path(kRepairFolder), files, Store::Mode::kReadOnly, settings, repaired)
           .ok()) {
    return as_told;
  }
  return as_told && records_in(*as_told) >= records_in(*repaired) ? std::move(as_told)
                                                                  : std::move(repaired);
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
