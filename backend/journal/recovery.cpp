// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/recovery.hpp"

#include <ctime>
#include <random>

#include "cairn/journal/held_deletions.hpp"
#include "cairn/journal/log_tail.hpp"
#include "cairn/journal/salvage.hpp"
#include "cairn/journal/snapshots.hpp"

namespace cairn {
namespace {

// A store is always made under another name: "rebuilding" may be thrown away, "rebuilt" is whole.
constexpr char kStore[] = "store", kRebuilding[] = "rebuilding", kRebuilt[] = "rebuilt";

std::uint64_t random_id() {
  std::random_device device;
  return static_cast<std::uint64_t>(device()) << 32 | device();
}

std::string utc_date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  return text;
}

// The environment's fault, not the store's: nothing may be concluded from it.
bool says_nothing_of_the_store(const rocksdb::Status& status) {
  return (status.IsIOError() && !status.IsPathNotFound()) || status.IsNoSpace() || status.IsBusy();
}

class Opening {
 public:
  Opening(const DataFolder& folder, const JournalOptions& options)
      : folder_(folder), options_(options), settings_{options.write_buffer_bytes} {}

  Result<OpenedStore> run() {
    Result<std::optional<StoreIdentity>> identity = folder_.read_identity();
    if (!identity) return identity.error();
    known_ = *identity;
    if (Result<void> done = finish_interrupted(); !done) return done.error();
    if (!folder_.has(kStore)) {
      if (!known_) return create();
      return replace("the folder " + folder_.path(kStore) + " is missing");
    }
    std::unique_ptr<Store> store;
    rocksdb::Status status = open(Store::Mode::kStrict, store);
    if (status.IsCorruption()) {
      const LogInspection logs = inspect_logs(folder_, kStore);
      if (logs.damage) return replace(*logs.damage);
      const auto manifest = cut_torn_manifest(folder_, kStore);
      if (!manifest) return manifest.error();
      opened_.report.cut_tail = logs.torn_tail ? logs.torn_tail : *manifest;
      if (opened_.report.cut_tail)
        status = open(logs.torn_tail ? Store::Mode::kCutTail : Store::Mode::kStrict, store);
    }
    if (says_nothing_of_the_store(status)) return storage_error(status, folder_.path(kStore));
    if (!status.ok()) return replace(status.ToString());
    if (std::optional<Error> flaw = check(*store)) {
      store.reset();
      return replace(flaw->to_string());
    }
    opened_.store = std::move(store);
    if (Result<void> agreed = agree_on_identity(); !agreed) return agreed.error();
    return std::move(opened_);
  }

 private:
  rocksdb::Status open(Store::Mode mode, std::unique_ptr<Store>& store) {
    held_ = std::make_shared<HeldDeletions>(folder_.files());
    return Store::open(folder_.path(kStore), held_, mode, settings_, store);
  }

  Result<void> finish_interrupted() const {
    for (const char* unfinished : {kRebuilding, kGatheringFolder}) {
      if (!folder_.has(unfinished)) continue;
      if (Result<void> gone = folder_.remove_folder(unfinished); !gone) return gone;
    }
    if (!folder_.has(kRebuilt)) return {};
    return folder_.has(kStore) ? folder_.remove_folder(kRebuilt) : folder_.rename(kRebuilt, kStore);
  }

  // Reads the chain from its beginning to its end: a start relies on all of it.
  std::optional<Error> check(Store& store) {
    const Store::Walk walk = store.walk({}, [](std::string_view) -> Result<void> { return {}; });
    if (walk.problem) return walk.problem;
    const Result<ChainPoint> head = store.read_head();
    if (!head) return head.error();
    if (*head != walk.last)
      return Error{ErrorCode::kBadInput, "the last record cannot be reached", store.folder()};
    for (const std::string& file : held_->held()) {
      if (last_record_of_table(store, file) <= head->number) continue;
      return Error{ErrorCode::kBadInput, "the MANIFEST has lost this table of records", file};
    }
    held_->release();
    opened_.head = *head;
    return std::nullopt;
  }

  // The file STORE and the store both know the identity; after an interruption the higher era is
  // the newer one.
  Result<void> agree_on_identity() {
    const std::optional<StoreIdentity> inside = opened_.store->read_identity();
    StoreIdentity agreed = inside ? *inside : known_.value_or(StoreIdentity{random_id(), 0});
    if (known_ && known_->store == agreed.store) agreed.era = std::max(agreed.era, known_->era);
    if (!inside || inside->era != agreed.era) {
      const rocksdb::Status status = opened_.store->write_identity(agreed);
      if (!status.ok()) return storage_error(status, opened_.store->folder());
    }
    opened_.identity = agreed;
    if (known_ && known_->store == agreed.store && known_->era == agreed.era) return {};
    return folder_.write_identity(agreed);
  }

  // A store under `rebuilding`, filled by `fill`, becomes the store; the one before it is set
  // aside.
  Result<OpenedStore> create() {
    opened_.report.created = true;
    if (Result<void> made = build({random_id(), 0}); !made) return made.error();
    return finish();
  }

  Result<OpenedStore> replace(const std::string& what) {
    OpenReport::Damage damage;
    damage.what = what;
    std::unique_ptr<Store> remains = gather_remains(folder_, kStore, settings_);
    StoreIdentity identity = known_.value_or(StoreIdentity{random_id(), 0});
    if (!known_ && remains) identity = remains->read_identity().value_or(identity);
    damage.era = ++identity.era;
    if (Result<void> built = build(identity, remains.get(), &damage); !built) return built.error();
    remains.reset();
    if (folder_.has(kGatheringFolder)) {
      if (Result<void> gone = folder_.remove_folder(kGatheringFolder); !gone) return gone.error();
    }
    if (folder_.has(kStore)) {
      damage.set_aside = "damaged-" + std::to_string(identity.era - 1) + '-' + utc_date();
      if (Result<void> moved = folder_.rename(kStore, damage.set_aside); !moved)
        return moved.error();
      damage.set_aside = folder_.path(damage.set_aside);
    }
    opened_.report.cut_tail.reset();
    opened_.report.damage = std::move(damage);
    known_ = identity;
    return finish();
  }

  Result<void> build(const StoreIdentity& identity, Store* remains = nullptr,
                     OpenReport::Damage* damage = nullptr) const {
    std::unique_ptr<Store> fresh;
    rocksdb::Status status = Store::open(folder_.path(kRebuilding), folder_.files(),
                                         Store::Mode::kCreate, settings_, fresh);
    if (status.ok()) status = fresh->write_identity(identity);
    if (status.ok() && remains) status = copy_good_part(*remains, *fresh, *damage);
    // Tables of both column families, so that they can be found again without a MANIFEST.
    if (status.ok()) status = fresh->flush();
    fresh.reset();
    if (!status.ok()) return storage_error(status, folder_.path(kRebuilding));
    return folder_.rename(kRebuilding, kRebuilt);
  }

  Result<OpenedStore> finish() {
    if (Result<void> named = folder_.rename(kRebuilt, kStore); !named) return named.error();
    std::unique_ptr<Store> store;
    const rocksdb::Status status = open(Store::Mode::kStrict, store);
    if (!status.ok()) return storage_error(status, folder_.path(kStore));
    if (std::optional<Error> flaw = check(*store)) return *flaw;
    opened_.store = std::move(store);
    if (Result<void> agreed = agree_on_identity(); !agreed) return agreed.error();
    return std::move(opened_);
  }

  const DataFolder& folder_;
  const JournalOptions& options_;
  const Store::Settings settings_;
  std::optional<StoreIdentity> known_;
  OpenedStore opened_;
  std::shared_ptr<HeldDeletions> held_;
};

}  // namespace

Result<OpenedStore> open_store(const DataFolder& folder, const JournalOptions& options) {
  return Opening(folder, options).run();
}

}  // namespace cairn
