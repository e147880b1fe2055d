// SPDX-License-Identifier: BSD-3-Clause
#include "tests/journal/recorded_disk.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace cairn::test {
namespace {

using rocksdb::FileOptions;
using rocksdb::FSDirectory;
using rocksdb::FSWritableFile;
using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;
using Kind = DiskEvent::Kind;

constexpr std::size_t kSector = 512;

std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

std::string plain(std::string path) {
  for (std::size_t at; (at = path.find("//")) != std::string::npos;) path.erase(at, 1);
  if (path.ends_with('/')) path.pop_back();
  return path;
}

class RecordedFile : public rocksdb::FSWritableFileOwnerWrapper {
 public:
  RecordedFile(std::unique_ptr<FSWritableFile> file, std::string path, RecordingFileSystem* disk)
      : FSWritableFileOwnerWrapper(std::move(file)), path_(std::move(path)), disk_(disk) {}

  IOStatus Append(const rocksdb::Slice& data, const IOOptions& options,
                  IODebugContext* debug) override {
    const IOStatus status = FSWritableFileOwnerWrapper::Append(data, options, debug);
    if (status.ok()) disk_->add({Kind::kAppend, path_, {}, data.ToString(), 0});
    return status;
  }
  IOStatus Append(const rocksdb::Slice& data, const IOOptions& options,
                  const rocksdb::DataVerificationInfo& /*verification*/,
                  IODebugContext* debug) override {
    return Append(data, options, debug);
  }
  IOStatus Truncate(std::uint64_t size, const IOOptions& options, IODebugContext* debug) override {
    const IOStatus status = FSWritableFileOwnerWrapper::Truncate(size, options, debug);
    if (status.ok()) disk_->add({Kind::kTruncate, path_, {}, {}, size});
    return status;
  }
  // What it does not do for real is not missed: the disk of these tests is the recording.
  IOStatus Sync(const IOOptions& /*options*/, IODebugContext* /*debug*/) override {
    if (!disk_->syncs_do_nothing()) disk_->add({Kind::kSync, path_, {}, {}, 0});
    return IOStatus::OK();
  }
  IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override {
    return Sync(options, debug);
  }

 private:
  std::string path_;
  RecordingFileSystem* disk_;
};

class RecordedFolder : public FSDirectory {
 public:
  RecordedFolder(std::string path, RecordingFileSystem* disk)
      : path_(std::move(path)), disk_(disk) {}
  IOStatus Fsync(const IOOptions& /*options*/, IODebugContext* /*debug*/) override {
    if (!disk_->syncs_do_nothing()) disk_->add({Kind::kSyncFolder, path_, {}, {}, 0});
    return IOStatus::OK();
  }

 private:
  std::string path_;
  RecordingFileSystem* disk_;
};

}  // namespace

RecordingFileSystem::RecordingFileSystem(bool syncs_do_nothing)
    : FileSystemWrapper(rocksdb::FileSystem::Default()), syncs_do_nothing_(syncs_do_nothing) {}

std::size_t RecordingFileSystem::event_count() const {
  const std::lock_guard lock(mutex_);
  return events_.size();
}

std::vector<DiskEvent> RecordingFileSystem::events() const {
  const std::lock_guard lock(mutex_);
  return events_;
}

void RecordingFileSystem::add(DiskEvent event) {
  event.path = plain(event.path);
  event.other = plain(event.other);
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

IOStatus RecordingFileSystem::NewWritableFile(const std::string& name, const FileOptions& options,
                                              std::unique_ptr<FSWritableFile>* file,
                                              IODebugContext* debug) {
  const IOStatus status = target()->NewWritableFile(name, options, file, debug);
  if (!status.ok()) return status;
  add({Kind::kCreate, name, {}, {}, 0});
  *file = std::make_unique<RecordedFile>(std::move(*file), name, this);
  return status;
}

IOStatus RecordingFileSystem::ReopenWritableFile(const std::string& name, const FileOptions&,
                                                 std::unique_ptr<FSWritableFile>*,
                                                 IODebugContext*) {
  return IOStatus::NotSupported("this test does not expect a file to be reopened", name);
}

IOStatus RecordingFileSystem::ReuseWritableFile(const std::string& name, const std::string&,
                                                const FileOptions&,
                                                std::unique_ptr<FSWritableFile>*, IODebugContext*) {
  return IOStatus::NotSupported("this test does not expect a file to be reused", name);
}

IOStatus RecordingFileSystem::NewDirectory(const std::string& name, const IOOptions&,
                                           std::unique_ptr<FSDirectory>* folder, IODebugContext*) {
  *folder = std::make_unique<RecordedFolder>(plain(name), this);
  return IOStatus::OK();
}

IOStatus RecordingFileSystem::DeleteFile(const std::string& name, const IOOptions& options,
                                         IODebugContext* debug) {
  const IOStatus status = target()->DeleteFile(name, options, debug);
  if (status.ok()) add({Kind::kDelete, name, {}, {}, 0});
  return status;
}

IOStatus RecordingFileSystem::RenameFile(const std::string& from, const std::string& to,
                                         const IOOptions& options, IODebugContext* debug) {
  const IOStatus status = target()->RenameFile(from, to, options, debug);
  if (status.ok()) add({Kind::kRename, from, to, {}, 0});
  return status;
}

IOStatus RecordingFileSystem::LinkFile(const std::string& from, const std::string& to,
                                       const IOOptions& options, IODebugContext* debug) {
  const IOStatus status = target()->LinkFile(from, to, options, debug);
  if (status.ok()) add({Kind::kLink, from, to, {}, 0});
  return status;
}

std::shared_ptr<rocksdb::FileSystem> unsynced_file_system() {
  return std::make_shared<RecordingFileSystem>(true);
}

// A folder is renamed with all that is in it.
void DiskModel::rename_in(Names& names, const DiskEvent& event) {
  Names moved;
  for (auto it = names.begin(); it != names.end();) {
    const bool inside = it->first == event.path || it->first.rfind(event.path + '/', 0) == 0;
    if (inside) moved[event.other + it->first.substr(event.path.size())] = it->second;
    it = inside ? names.erase(it) : std::next(it);
  }
  for (auto& [path, file] : moved) names[path] = std::move(file);
}

void DiskModel::change_names(Names& names, const Change& change) {
  const DiskEvent& event = change.event;
  if (event.kind == Kind::kCreate) names[event.path] = change.file;
  if (event.kind == Kind::kLink) names[event.other] = change.file;
  if (event.kind == Kind::kDelete) names.erase(event.path);
  if (event.kind == Kind::kRename) rename_in(names, event);
}

void DiskModel::apply(const DiskEvent& event) {
  const auto found = names_.find(event.path);
  File* file = found == names_.end() ? nullptr : found->second.get();
  switch (event.kind) {
    case Kind::kAppend:
      if (file) file->bytes += event.data;
      return;
    case Kind::kTruncate:
      if (!file) return;
      file->bytes.resize(event.size);
      file->synced = std::min<std::size_t>(file->synced, event.size);
      return;
    case Kind::kSync:
      if (file) file->synced = file->bytes.size();
      return;
    case Kind::kSyncFolder: {
      // The changes in this folder and, because they are kept in order, all before them.
      std::size_t kept = 0;
      for (std::size_t i = 0; i < unsynced_.size(); ++i) {
        const DiskEvent& change = unsynced_[i].event;
        if (folder_of(change.path) == event.path || folder_of(change.other) == event.path)
          kept = i + 1;
      }
      for (std::size_t i = 0; i < kept; ++i) change_names(durable_, unsynced_[i]);
      unsynced_.erase(unsynced_.begin(), unsynced_.begin() + static_cast<std::ptrdiff_t>(kept));
      return;
    }
    default:
      break;
  }
  Change change{event, nullptr};
  if (event.kind == Kind::kCreate) change.file = std::make_shared<File>();
  if (event.kind == Kind::kLink && file) change.file = found->second;
  change_names(names_, change);
  unsynced_.push_back(std::move(change));
}

void DiskModel::write_after_power_loss(const std::string& root, const std::string& folder,
                                       std::mt19937& random) const {
  Names left = durable_;
  const std::size_t changes = random() % (unsynced_.size() + 1);
  for (std::size_t i = 0; i < changes; ++i) change_names(left, unsynced_[i]);
  std::filesystem::create_directories(folder);
  for (const auto& [path, file] : left) {
    if (path.rfind(root + '/', 0) != 0) continue;
    const std::size_t loose = file->bytes.size() - file->synced;
    std::string bytes = file->bytes.substr(0, file->synced + random() % (loose + 1));
    // A third of the sectors that were not synced never arrived: zeros, or what was there before.
    for (std::size_t at = file->synced; at < bytes.size(); at += kSector - at % kSector) {
      if (random() % 3 != 0) continue;
      const std::size_t end = std::min(bytes.size(), at + kSector - at % kSector);
      const bool zeros = random() % 2 == 0;
      for (std::size_t i = at; i < end; ++i) bytes[i] = zeros ? '\0' : static_cast<char>(random());
    }
    const std::filesystem::path target = folder + path.substr(root.size());
    std::filesystem::create_directories(target.parent_path());
    std::ofstream(target, std::ios::binary) << bytes;
  }
}

}  // namespace cairn::test
