// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace cairn {
namespace fs = std::filesystem;
namespace {

constexpr mode_t kDefaultMode = 0666;  // before the umask

Error cannot(const char* what, const std::string& path, int error) {
  const bool machine = error == ENOSPC || error == EDQUOT || error == EIO || error == EMFILE;
  const ErrorCode code = machine ? ErrorCode::kInternal : ErrorCode::kUsage;
  const char* hint = machine ? "" : "; choose a folder that exists and that you may write to";
  return {code, std::string("cannot ") + what + ": " + std::strerror(error) + hint, path};
}

// The file behind `path`: links are followed, so that a rename replaces what they point at.
fs::path resolved(const std::string& path) {
  std::error_code ignored;
  const fs::path target = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return target.empty() ? fs::path(path) : target;
}

bool is_written_in_place(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

// A new file beside `path` that no other process uses; its name goes to `temporary`.
int open_temporary(const fs::path& path, std::string& temporary) {
  struct stat existing {};
  const bool exists = stat(path.c_str(), &existing) == 0;
  for (int attempt = 0;; ++attempt) {
    temporary = path.string() + ".tmp" + std::to_string(getpid()) + "-" + std::to_string(attempt);
    const int descriptor =
        open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kDefaultMode);
    if (descriptor >= 0 && exists) (void)fchmod(descriptor, existing.st_mode & 07777);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
}

}  // namespace

OutputFile::OutputFile(std::FILE* file, std::string path, std::string temporary)
    : file_(file), path_(std::move(path)), temporary_(std::move(temporary)) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : file_(std::exchange(other.file_, nullptr)),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})) {}

OutputFile::~OutputFile() {
  if (file_ && file_ != stdout) std::fclose(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

Result<OutputFile> OutputFile::create(const std::string& path) {
  if (path == "-") return OutputFile(stdout, "standard output", "");
  const fs::path target = resolved(path);
  if (fs::is_directory(target)) return cannot("write", path, EISDIR);
  if (is_written_in_place(target)) {
    std::FILE* file = std::fopen(target.c_str(), "wb");
    if (!file) return cannot("write", path, errno);
    return OutputFile(file, target, "");
  }
  std::string temporary;
  const int descriptor = open_temporary(target, temporary);
  if (descriptor < 0) return cannot("create the file", path, errno);
  return OutputFile(fdopen(descriptor, "wb"), target, std::move(temporary));
}

Error OutputFile::failure(const char* what) const { return cannot(what, path_, errno); }

Result<void> OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) return failure("write");
  return {};
}

Result<void> OutputFile::commit() {
  std::FILE* file = std::exchange(file_, nullptr);
  const bool written = (file == stdout ? std::fflush(file) : std::fclose(file)) == 0;
  if (!written) return failure("write");
  if (temporary_.empty()) return {};
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) return failure("rename to");
  temporary_.clear();
  return {};
}

Result<void> write_file(const std::string& path, std::string_view bytes) {
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return file.error();
  if (Result<void> written = file->write(bytes); !written) return written;
  return file->commit();
}

Result<void> check_writable(const std::string& path) {
  if (path == "-") return {};
  const fs::path target = resolved(path);
  std::error_code ignored;
  if (fs::is_directory(target, ignored)) return cannot("write", path, EISDIR);
  const fs::path checked = is_written_in_place(target) ? target : target.parent_path();
  if (!fs::exists(checked, ignored)) return cannot("create the file", path, ENOENT);
  if (access(checked.c_str(), W_OK) != 0) return cannot("create the file", path, errno);
  return {};
}

}  // namespace cairn
