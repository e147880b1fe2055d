// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/payload_spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "cairn-payload 1 ";
constexpr char kExtension[] = ".payload";

bool write_file(const fs::path& path, std::string_view head, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return false;
  bool written = true;
  for (std::string_view rest : {head, bytes}) {
    while (written && !rest.empty()) {
      const ssize_t count = ::write(file, rest.data(), rest.size());
      if (count < 0 && errno == EINTR) continue;
      written = count > 0;
      if (written) rest.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  written = written && fsync(file) == 0;
  return close(file) == 0 && written;
}

void sync_folder(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)fsync(file);  // file systems that cannot sync folders say so here
  close(file);
}

}  // namespace

fs::path PayloadSpool::path_of(std::uint64_t number) const {
  return folder_ / (std::to_string(number) + kExtension);
}

Result<PayloadSpool> PayloadSpool::open(const fs::path& folder, std::uint64_t most_bytes) {
  PayloadSpool spool(folder, most_bytes);
  std::error_code failed;
  fs::create_directories(folder, failed);
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != kExtension || stem.empty() || stem.size() > 19 ||
        stem.find_first_not_of("0123456789") != std::string::npos)
      continue;
    const std::uint64_t number = std::stoull(stem);
    const auto content = spool.read(number);
    if (!content) return content.error();
    spool.kept_[number] = {content_hash(content->bytes), entry.file_size()};
    spool.bytes_ += entry.file_size();
    spool.next_ = std::max(spool.next_, number + 1);
  }
  if (failed)
    return Error{ErrorCode::kUsage, "cannot use the payload folder: " + failed.message(),
                 folder.string()};
  return spool;
}

Result<std::uint64_t> PayloadSpool::append(std::string_view type, std::string_view bytes) {
  const ContentHash hash = content_hash(bytes);
  const std::string head = std::string(kMagic) + to_string(hash) + ' ' + std::string(type) + '\n';
  const std::uint64_t size = head.size() + bytes.size();
  if (bytes_ + size > most_bytes_)
    return Error{ErrorCode::kNotUsable,
                 "spool full: payloads of " + std::to_string(bytes_) + " of " +
                     std::to_string(most_bytes_) + " bytes wait for the daemon; is it running?",
                 folder_.string()};
  const fs::path temporary = folder_ / "new";
  const fs::path path = path_of(next_);
  if (!write_file(temporary, head, bytes) || std::rename(temporary.c_str(), path.c_str()) != 0)
    return Error{ErrorCode::kInternal,
                 std::string("cannot write a payload: ") + std::strerror(errno), path.string()};
  sync_folder(folder_);
  kept_[next_] = {hash, size};
  bytes_ += size;
  return next_++;
}

Result<PayloadSpool::Content> PayloadSpool::read(std::uint64_t number) const {
  const fs::path path = path_of(number);
  std::ifstream in(path, std::ios::binary);
  std::string head;
  std::getline(in, head);
  Content content;
  content.bytes.assign(std::istreambuf_iterator<char>(in), {});
  const std::string expected = std::string(kMagic) + to_string(content_hash(content.bytes)) + ' ';
  if (!head.starts_with(expected))
    return Error{ErrorCode::kBadInput,
                 "is damaged: its bytes do not have the hash that its first line says; move it "
                 "away to go on without it",
                 path.string()};
  content.type = head.substr(expected.size());
  return content;
}

void PayloadSpool::remove(std::uint64_t number) {
  const auto kept = kept_.find(number);
  if (kept == kept_.end()) return;
  std::error_code ignored;  // what stays is sent once more by the next run
  fs::remove(path_of(number), ignored);
  bytes_ -= kept->second.bytes;
  kept_.erase(kept);
}

}  // namespace cairn
