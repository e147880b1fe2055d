// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/input_text.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "cairn/io/compression.hpp"

namespace cairn {
namespace {

constexpr std::size_t kFirstChunk = std::size_t{1} << 16;

std::size_t memory_limit() {
  const long pages = sysconf(_SC_PHYS_PAGES), page_size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_size <= 0) return std::size_t{1} << 32;
  return static_cast<std::size_t>(pages) * static_cast<std::size_t>(page_size) / 2;
}

Error unreadable(const std::string& path, int error) {
  return {ErrorCode::kBadInput, std::string("cannot read: ") + std::strerror(error),
          input_name(path)};
}

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ > STDERR_FILENO) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int value() const { return fd_; }

 private:
  int fd_;
};

// Where more is to come the buffer doubles; a regular file fits at once.
std::shared_ptr<char[]> grow(const std::shared_ptr<char[]>& bytes, std::size_t size,
                             std::size_t capacity) {
  auto larger = std::make_shared_for_overwrite<char[]>(capacity);
  std::memcpy(larger.get(), bytes.get(), size);
  return larger;
}

Result<InputText> read_all(int fd, const std::string& path, std::size_t limit) {
  struct stat status {};
  const bool regular = fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
  std::size_t capacity = regular ? static_cast<std::size_t>(status.st_size) + 1 : kFirstChunk;
  const auto too_long = [&] {
    return Error{ErrorCode::kBadInput, "longer than half of this machine's memory; split it first",
                 input_name(path)};
  };
  if (capacity > limit) return too_long();
  auto bytes = std::make_shared_for_overwrite<char[]>(capacity);
  std::size_t size = 0;
  while (true) {
    if (size == capacity) {
      if (capacity > limit / 2) return too_long();
      bytes = grow(bytes, size, 2 * capacity);
      capacity *= 2;
    }
    const ssize_t got = read(fd, bytes.get() + size, capacity - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable(path, errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  return InputText{bytes, {bytes.get(), size}};
}

}  // namespace

std::string input_name(const std::string& path) { return path == "-" ? "<stdin>" : path; }

Result<InputText> read_input_text(const std::string& path) {
  const Descriptor file(path == "-" ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.value() < 0) return unreadable(path, errno);
  const std::size_t limit = memory_limit();
  auto raw = read_all(file.value(), path, limit);
  if (!raw) return raw;
  const Compression compression = recognize_compression(raw->view);
  if (compression == Compression::kNone) return raw;
  auto text = decompress(raw->view, compression, input_name(path), limit);
  if (!text) return text.error();
  const auto owner = std::make_shared<const std::string>(std::move(*text));
  return InputText{owner, *owner};
}

}  // namespace cairn
