// SPDX-License-Identifier: BSD-3-Clause
// Payloads of a Journal: bytes that are named by their content.
#include <set>

#include "cairn/journal/journal.hpp"
#include "cairn/journal/store.hpp"

namespace cairn {
namespace {

void for_each_payload_of(const Record& record,
                         const std::function<void(const ContentHash&)>& visit) {
  const auto* decision = std::get_if<TransactionRecord>(&record.body);
  const auto* accepted = decision ? std::get_if<Transaction>(&decision->outcome) : nullptr;
  if (!accepted) return;
  for (const NewFactor& factor : accepted->factors)
    for (const ContentHash& hash : factor.payloads) visit(hash);
}

}  // namespace

Result<ContentHash> Journal::put_payload(std::string_view bytes) {
  const ContentHash hash = content_hash(bytes);
  if (Result<void> usable = check_usable(); !usable) return usable.error();
  if (space() == DiskSpace::kFull) {
    return Error{ErrorCode::kInternal, "storage full: under 2 % of the disk is free",
                 store_->folder()};
  }
  rocksdb::WriteBatch batch;
  if (has_payload(hash))
    store_->put_payload_time(batch, hash);  // its transaction may be late once more
  else
    store_->put_payload(batch, hash, bytes);
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

Result<std::uint64_t> Journal::collect_payloads(std::int64_t before_ns,
                                                const std::function<bool()>& go_on) {
  if (Result<void> usable = check_usable(); !usable) return usable.error();
  std::set<ContentHash> named, unnamed;
  const Result<void> listed =
      store_->walk_payload_times([&](const ContentHash& hash, std::int64_t came_ns) {
        if (came_ns < before_ns) unnamed.insert(hash);
      });
  if (!listed) return listed.error();
  if (unnamed.empty()) return 0;

  std::uint64_t seen = 0;
  const auto look = [&](const Record& record) -> Result<void> {
    if (!go_on()) return Error{ErrorCode::kUnreachable, "stopped before all records were seen"};
    seen = record.number;
    for_each_payload_of(record, [&](const ContentHash& hash) {
      if (const auto found = unnamed.extract(hash)) named.insert(found.value());
    });
    return {};
  };
  if (const Result<void> most = for_each(1, look); !most) return most.error();
  const std::lock_guard nothing_is_appended(append_mutex_);
  if (const Result<void> rest = for_each(seen + 1, look); !rest) return rest.error();

  rocksdb::WriteBatch batch;
  for (const ContentHash& hash : named) store_->forget_payload_time(batch, hash);
  for (const ContentHash& hash : unnamed) store_->delete_payload(batch, hash);
  const rocksdb::Status status = store_->write(batch);
  if (!status.ok()) return fail(storage_error(status, store_->folder()));
  return unnamed.size();
}

}  // namespace cairn
