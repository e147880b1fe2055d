// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace cairn::test {

/// A public data file or folder: $CAIRN_DATASETS/path, by default ../shared/datasets beside the
/// source tree. Nothing where it is absent: skip the test with CAIRN_REQUIRE_DATASET.
inline std::optional<std::filesystem::path> dataset(const std::string& path) {
  const char* root = std::getenv("CAIRN_DATASETS");
  const std::filesystem::path full =
      (root ? std::filesystem::path(root)
            : std::filesystem::path(CAIRN_SOURCE_DIR) / "../shared/datasets") /
      path;
  if (!std::filesystem::exists(full)) return std::nullopt;
  return full;
}

}  // namespace cairn::test

/// Defines `variable` as the path of a data file, or reports the test as skipped.
#define CAIRN_REQUIRE_DATASET(variable, path)                                                     \
  const auto variable##_found = cairn::test::dataset(path);                                       \
  if (!variable##_found) GTEST_SKIP() << "data set " << path << " is absent; set CAIRN_DATASETS"; \
  const std::string variable = variable##_found->string()
