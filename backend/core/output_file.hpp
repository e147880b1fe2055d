// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "cairn/core/result.hpp"

namespace cairn {

/// A file that appears under its name only when it is complete. Bytes go to a temporary file beside
/// it; commit() renames it, and without commit() nothing is left behind. "-" is standard output;
/// devices and pipes are written in place. Errors: kUsage where the path cannot be written,
/// kInternal where the machine fails (disk full).
class OutputFile {
 public:
  static Result<OutputFile> create(const std::string& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  Result<void> write(std::string_view bytes);
  Result<void> commit();

 private:
  OutputFile(std::FILE* file, std::string path, std::string temporary);
  [[nodiscard]] Error failure(const char* what) const;

  std::FILE* file_;        // null after commit
  std::string path_;       // with symbolic links resolved
  std::string temporary_;  // empty when written in place
};

/// Writes a whole file through OutputFile.
Result<void> write_file(const std::string& path, std::string_view bytes);

/// Tells early, before long work, that `path` cannot be written: its folder is missing or not
/// writable.
Result<void> check_writable(const std::string& path);

}  // namespace cairn
