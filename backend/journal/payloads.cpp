// SPDX-License-Identifier: BSD-3-Clause
// Payloads of a Journal: bytes that are named by their content.
#include <algorithm>
#include <vector>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {

Result<ContentHash> Journal::put_payload(std::string_view bytes) {
  const ContentHash hash = content_hash(bytes);
  if (Result<void> usable = check_usable(); !usable) return usable.error();
  if (has_payload(hash)) return hash;
  if (space() == DiskSpace::kFull) {
    return Error{ErrorCode::kInternal, "storage full: under 2 % of the disk is free",
                 store_->folder()};
  }
  rocksdb::WriteBatch batch;
  batch.Put(store_->payloads(), slice(hash), slice(bytes));
  const rocksdb::Status status = store_->write(batch);
  if (!status.ok()) return fail(storage_error(status, store_->folder()));
  return hash;
}

bool Journal::has_payload(const ContentHash& hash) const { return read_payload(hash).ok(); }

Result<std::string> Journal::read_payload(const ContentHash& hash) const {
  std::string bytes;
  const std::string place = store_->folder() + ": payload " + to_string(hash);
  const rocksdb::Status status =
      store_->db().Get(rocksdb::ReadOptions(), store_->payloads(), slice(hash), &bytes);
  if (status.IsNotFound()) return Error{ErrorCode::kBadInput, "there is no such payload", place};
  if (!status.ok()) return storage_error(status, place);
  if (content_hash(bytes) != hash)
    return Error{ErrorCode::kBadInput, "its bytes have changed", place};
  return bytes;
}

Result<std::uint64_t> Journal::collect_payloads(
    const std::function<bool(const ContentHash&)>& is_referenced) {
  if (Result<void> usable = check_usable(); !usable) return usable.error();
  rocksdb::WriteBatch batch;
  std::uint64_t collected = 0;
  const Result<void> walked = store_->walk_payloads([&](const ContentHash& hash, std::string_view) {
    if (is_referenced(hash)) return true;
    batch.Delete(store_->payloads(), slice(hash));
    ++collected;
    return true;
  });
  if (!walked) return walked.error();
  if (collected == 0) return collected;
  const rocksdb::Status status = store_->write(batch);
  if (!status.ok()) return fail(storage_error(status, store_->folder()));
  return collected;
}

}  // namespace cairn
