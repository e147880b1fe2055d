// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/data_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace cairn {
namespace {

using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;

constexpr int kFolderFormat = 1;

Error lock_error(const std::string& place, const std::string& message) {
  return {ErrorCode::kInternal, message, place};
}

// A lock of the open file, not of the process: it keeps out a second journal of ours as well.
bool lock_whole(int descriptor, short type) {
  struct flock whole {};
  whole.l_type = type;
  whole.l_whence = SEEK_SET;
  return ::fcntl(descriptor, F_OFD_SETLK, &whole) == 0;
}

std::string holder_of(int descriptor) {
  char holder[32] = {};
  return ::pread(descriptor, holder, sizeof holder - 1, 0) > 0 ? holder : "(unknown)";
}

}  // namespace

Error storage_error(const rocksdb::Status& status, const std::string& place) {
  if (status.IsNoSpace())
    return {ErrorCode::kInternal, "the disk is full (" + status.ToString() + "): free some space",
            place};
  const bool broken = status.IsCorruption();
  return {broken ? ErrorCode::kBadInput : ErrorCode::kInternal, status.ToString(), place};
}

DataFolder::DataFolder(std::string folder, std::shared_ptr<rocksdb::FileSystem> files)
    : folder_(std::move(folder)), files_(std::move(files)) {}

bool DataFolder::has(const std::string& name) const {
  return files_->FileExists(path(name), IOOptions(), nullptr).ok();
}

std::vector<std::string> DataFolder::list(const std::string& name) const {
  std::vector<std::string> names;
  if (!files_->GetChildren(path(name), IOOptions(), &names, nullptr).ok()) return {};
  std::erase_if(names, [](const std::string& entry) { return entry == "." || entry == ".."; });
  std::sort(names.begin(), names.end());
  return names;
}

Result<void> DataFolder::sync_folder(const std::string& folder) const {
  std::unique_ptr<rocksdb::FSDirectory> directory;
  IOStatus status = files_->NewDirectory(folder, IOOptions(), &directory, nullptr);
  if (status.ok()) status = directory->Fsync(IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, folder);
  return {};
}

Result<void> DataFolder::create(const std::string& name) const {
  const IOStatus status = files_->CreateDirIfMissing(path(name), IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, path(name));
  return sync_folder(folder_);
}

Result<void> DataFolder::write(const std::string& name, const std::string& bytes) const {
  const std::string part = path(name) + ".part";
  IOStatus status = rocksdb::WriteStringToFile(files_.get(), bytes, part, true);
  if (status.ok()) status = files_->RenameFile(part, path(name), IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, path(name));
  return sync_folder(path(name).substr(0, path(name).rfind('/')));
}

std::optional<std::string> DataFolder::read(const std::string& name) const {
  std::string bytes;
  if (!rocksdb::ReadFileToString(files_.get(), path(name), &bytes).ok()) return std::nullopt;
  return bytes;
}

Result<void> DataFolder::rename(const std::string& from, const std::string& to) const {
  const IOStatus status = files_->RenameFile(path(from), path(to), IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, path(from));
  return sync_folder(folder_);
}

Result<void> DataFolder::remove(const std::string& name) const {
  const IOStatus status = files_->DeleteFile(path(name), IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, path(name));
  return {};
}

Result<void> DataFolder::remove_folder(const std::string& name) const {
  for (const std::string& entry : list(name)) {
    const std::string inner = name + '/' + entry;
    bool is_folder = false;
    IOStatus status = files_->IsDirectory(path(inner), IOOptions(), &is_folder, nullptr);
    if (!status.ok()) return storage_error(status, path(inner));
    if (Result<void> gone = is_folder ? remove_folder(inner) : remove(inner); !gone) return gone;
  }
  const IOStatus status = files_->DeleteDir(path(name), IOOptions(), nullptr);
  if (!status.ok()) return storage_error(status, path(name));
  return {};
}

Result<std::optional<StoreIdentity>> DataFolder::read_identity() const {
  const std::optional<std::string> text = read("STORE");
  int format = 0;
  unsigned long long store = 0;
  unsigned era = 0;
  // The last line says that the file is whole.
  const int found = text ? std::sscanf(text->c_str(), "cairn store format %d\nid %16llx\nera %u\n",
                                       &format, &store, &era)
                         : 0;
  if (found >= 1 && format > kFolderFormat) {
    return Error{ErrorCode::kBadInput,
                 "this data folder has format " + std::to_string(format) +
                     ", this Cairn knows format 1 only: open it with the Cairn that wrote it",
                 path("STORE")};
  }
  if (found != 3 || !text->ends_with("\nend\n")) return std::optional<StoreIdentity>{};
  return std::optional<StoreIdentity>{{store, era}};
}

Result<void> DataFolder::write_identity(const StoreIdentity& identity) const {
  char text[128];
  std::snprintf(text, sizeof text, "cairn store format %d\nid %016llx\nera %u\nend\n",
                kFolderFormat, static_cast<unsigned long long>(identity.store), identity.era);
  return write("STORE", text);
}

Result<std::unique_ptr<FolderLock>> FolderLock::take(const std::string& folder) {
  const std::string place = folder + "/LOCK";
  const int descriptor = ::open(place.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    return lock_error(place, std::string("cannot lock the data folder: ") + std::strerror(errno) +
                                 "; it must exist and be writable");
  }
  std::unique_ptr<FolderLock> lock(new FolderLock(descriptor));
  if (!lock_whole(descriptor, F_WRLCK)) {
    if (lock_whole(descriptor, F_RDLCK)) {
      return Error{ErrorCode::kUsage,
                   "the data folder is being read (cairn verify, log, ...); try again", place};
    }
    return Error{ErrorCode::kUsage,
                 "the data folder is in use by process " + holder_of(descriptor) +
                     "; stop it, or use another folder",
                 place};
  }
  const std::string own = std::to_string(::getpid());
  if (::ftruncate(descriptor, 0) != 0 ||
      ::pwrite(descriptor, own.data(), own.size(), 0) != static_cast<ssize_t>(own.size())) {
    return lock_error(place, std::string("cannot write: ") + std::strerror(errno));
  }
  return lock;
}

Result<std::unique_ptr<FolderLock>> FolderLock::take_for_reading(const std::string& folder) {
  const std::string place = folder + "/LOCK";
  const int descriptor = ::open(place.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0 && errno != ENOENT)
    return lock_error(place, std::string("cannot read: ") + std::strerror(errno));
  std::unique_ptr<FolderLock> lock(new FolderLock(descriptor));
  if (descriptor < 0 || lock_whole(descriptor, F_RDLCK)) return lock;
  return Error{ErrorCode::kUsage,
               "the data folder is in use by process " + holder_of(descriptor) +
                   "; stop it first, or ask the daemon itself (--domain)",
               place};
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace cairn
