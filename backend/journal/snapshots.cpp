// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/snapshots.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "cairn/core/bytes.hpp"
#include "cairn/journal/record.hpp"

namespace cairn {
namespace {

constexpr char kFolder[] = "snapshots";
constexpr std::uint16_t kVersion = 1;
constexpr std::size_t kKept = 2;

std::string file_name(std::uint64_t number) {
  char name[32];
  std::snprintf(name, sizeof name, "%020llu", static_cast<unsigned long long>(number));
  return std::string(kFolder) + '/' + name;
}

// Newest first.
std::vector<std::string> snapshot_files(const DataFolder& folder) {
  std::vector<std::string> names = folder.list(kFolder);
  std::erase_if(names, [](const std::string& name) { return name.size() != 20; });
  std::reverse(names.begin(), names.end());
  for (std::string& name : names) name = std::string(kFolder) + '/' + name;
  return names;
}

std::optional<StoredSnapshot> decode(std::string_view bytes) {
  if (bytes.size() < sizeof(ContentHash)) return std::nullopt;
  const std::string_view hashed = bytes.substr(0, bytes.size() - sizeof(ContentHash));
  if (ByteReader(bytes.substr(hashed.size())).hash() != content_hash(hashed)) return std::nullopt;
  ByteReader from(hashed);
  if (from.integer<std::uint16_t>() != kVersion) return std::nullopt;
  StoredSnapshot snapshot;
  snapshot.at.number = from.integer<std::uint64_t>();
  snapshot.at.hash = from.hash();
  snapshot.bytes = from.raw(from.left());
  if (!from.ok()) return std::nullopt;
  return snapshot;
}

std::optional<StoredSnapshot> read_valid(const DataFolder& folder, Store& store,
                                         const std::string& name) {
  const std::optional<std::string> bytes = folder.read(name);
  std::optional<StoredSnapshot> snapshot = bytes ? decode(*bytes) : std::nullopt;
  if (!snapshot) return std::nullopt;
  const Result<std::string> record = store.read_record(snapshot->at.number);
  if (!record || chain_in(*record) != snapshot->at.hash) return std::nullopt;
  return snapshot;
}

}  // namespace

Result<void> write_snapshot_file(const DataFolder& folder, Store& store, const ChainPoint& at,
                                 std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + 80);
  ByteWriter to(text);
  to.integer(kVersion);
  to.integer(at.number);
  to.hash(at.hash);
  to.raw(bytes);
  to.hash(content_hash(text));
  if (Result<void> made = folder.create(kFolder); !made) return made;
  if (Result<void> written = folder.write(file_name(at.number), text); !written) return written;
  std::size_t valid = 0;
  for (const std::string& name : snapshot_files(folder)) {
    if (valid == kKept) {
      if (Result<void> removed = folder.remove(name); !removed) return removed;
    } else if (read_valid(folder, store, name)) {
      ++valid;
    }
  }
  return {};
}

std::optional<StoredSnapshot> read_newest_snapshot(const DataFolder& folder, Store& store) {
  for (const std::string& name : snapshot_files(folder)) {
    if (std::optional<StoredSnapshot> snapshot = read_valid(folder, store, name)) return snapshot;
  }
  return std::nullopt;
}

}  // namespace cairn
