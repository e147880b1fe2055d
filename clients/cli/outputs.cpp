// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/outputs.hpp"

#include <filesystem>
#include <set>

#include "cairn/core/output_file.hpp"
#include "cairn/io/compression.hpp"

namespace cairn::cli {

Result<void> check_outputs(const std::vector<std::string>& paths) {
  std::set<std::filesystem::path> seen;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::error_code ignored;
    const std::filesystem::path file =
        std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
    const bool is_new = seen.insert(path == "-" ? std::filesystem::path(path) : file).second;
    if (!is_new && path == "-") {
      return Error{ErrorCode::kUsage,
                   "two outputs go to standard output ('-'); give one of them a file name"};
    }
    if (!is_new &&
        std::filesystem::status(path, ignored).type() != std::filesystem::file_type::character) {
      return Error{ErrorCode::kUsage, "two outputs have this name; give each its own", path};
    }
    if (Result<void> writable = check_writable(path); !writable) return writable;
  }
  return {};
}

Result<void> write_files(const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<OutputFile> open;
  for (const auto& [path, content] : files) {
    Result<OutputFile> file = OutputFile::create(path);
    if (!file) return file.error();
    if (auto written = file->write(compress(content, compression_for(path))); !written)
      return written;
    open.push_back(std::move(*file));
  }
  for (OutputFile& file : open) {
    if (auto done = file.commit(); !done) return done;
  }
  return {};
}

}  // namespace cairn::cli
