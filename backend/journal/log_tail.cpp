// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/log_tail.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "cairn/core/bytes.hpp"

namespace cairn {
namespace {

// RocksDB's log format: blocks of 32 KiB hold fragments {crc u32, length u16, type u8, data}; a
// block's last bytes are padding where no header fits. A write is one whole fragment, or a first,
// middle ones and a last. Its data begin with {sequence u64, count u32}.
constexpr std::size_t kBlockSize = 32768;
constexpr std::size_t kHeaderSize = 7;
enum FragmentType : std::uint8_t { kZero = 0, kFull = 1, kFirst = 2, kMiddle = 3, kLast = 4 };

std::uint32_t masked_crc32c(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t crc = i;
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78u : 0u);
      table[i] = crc;
    }
    return table;
  }();
  std::uint32_t crc = ~0u;
  for (const char byte : bytes)
    crc = crc >> 8 ^ kTable[(crc ^ static_cast<unsigned char>(byte)) & 255];
  crc = ~crc;
  return (crc >> 15 | crc << 17) + 0xA282EAD8u;
}

struct Fragment {
  FragmentType type = kZero;
  std::string_view data;
  bool whole = false;  // its checksum is right
};

Fragment fragment_at(std::string_view log, std::size_t place) {
  const std::size_t block_end = std::min(log.size(), place - place % kBlockSize + kBlockSize);
  Fragment fragment;
  if (place + kHeaderSize > block_end) return fragment;
  ByteReader header(log.substr(place, kHeaderSize));
  const auto crc = header.integer<std::uint32_t>();
  const auto length = header.integer<std::uint16_t>();
  fragment.type = static_cast<FragmentType>(header.integer<std::uint8_t>());
  if (place + kHeaderSize + length > block_end) return fragment;
  fragment.data = log.substr(place + kHeaderSize, length);
  fragment.whole = crc == masked_crc32c(log.substr(place + 6, length + 1u));
  return fragment;
}

constexpr std::size_t kLeastWrite = 12;  // of a log; the MANIFEST has shorter ones

bool begins_a_write(const Fragment& fragment, std::size_t least_write) {
  return fragment.whole && (fragment.type == kFull || fragment.type == kFirst) &&
         fragment.data.size() >= least_write;
}

struct Log {
  std::size_t good_end = 0;          // the first byte that is not part of a whole write
  bool clean = false;                // nothing but padding follows
  std::uint64_t first_sequence = 0;  // 0: no write
  std::uint64_t next_sequence = 0;   // after the last whole write
  bool write_after_the_break = false;
};

// Where the next block starts, unless `place` has room for a header.
std::size_t skip_padding(std::size_t place) {
  const std::size_t in_block = place % kBlockSize;
  return in_block + kHeaderSize > kBlockSize ? place - in_block + kBlockSize : place;
}

using OnWrite = std::function<void(std::string_view)>;

Log inspect(std::string_view bytes, std::size_t least_write = kLeastWrite,
            const OnWrite& on_write = {}) {
  Log log;
  std::string write;
  bool inside = false;
  std::uint64_t after = 0;  // the sequence after the write that is being read
  std::size_t place = 0;
  for (;;) {
    place = skip_padding(place);
    const Fragment fragment = fragment_at(bytes, std::min(place, bytes.size()));
    const bool starts = begins_a_write(fragment, least_write);
    const bool goes_on = fragment.whole && (fragment.type == kMiddle || fragment.type == kLast);
    if (place >= bytes.size() || !(inside ? goes_on : starts)) break;
    if (starts) write.clear();
    write += fragment.data;
    if (starts) {
      ByteReader data(fragment.data);
      const auto sequence = data.integer<std::uint64_t>();
      after = sequence + data.integer<std::uint32_t>();
      if (log.first_sequence == 0) log.first_sequence = sequence;
    }
    place += kHeaderSize + fragment.data.size();
    inside = fragment.type == kFirst || fragment.type == kMiddle;
    if (!inside) {
      if (on_write) on_write(write);
      log.good_end = place;
      log.next_sequence = after;
    }
  }
  const std::size_t broken = std::min(place, bytes.size());
  // Of zeros that are fewer than a header RocksDB says that one is truncated.
  const std::size_t rest = bytes.size() - broken;
  log.clean = !inside && (rest == 0 || rest >= kHeaderSize) &&
              bytes.find_first_not_of('\0', broken) == std::string_view::npos;
  // From the break on, fragment by fragment while lengths lead to whole ones, else block by block.
  bool first = true;
  while (place < bytes.size() && !log.write_after_the_break) {
    const Fragment fragment = fragment_at(bytes, place);
    log.write_after_the_break = begins_a_write(fragment, least_write);
    const bool follow = (fragment.whole || first) && !fragment.data.empty();
    place = follow ? skip_padding(place + kHeaderSize + fragment.data.size())
                   : place - place % kBlockSize + kBlockSize;
    first = false;
  }
  return log;
}

}  // namespace

LogInspection inspect_logs(const DataFolder& folder, const std::string& store) {
  LogInspection found;
  std::uint64_t expected = 0;  // the sequence after a log that ends in a break
  for (const std::string& file : folder.list(store)) {
    if (!file.ends_with(".log")) continue;
    const std::string name = store + '/' + file;
    const Log log = inspect(folder.read(name).value_or(""));
    // A cut was made here before, and writing went on: not a flaw if nothing is missing.
    if (found.torn_tail && log.first_sequence > 0) {
      if (expected != 0 && log.first_sequence != expected) found.damage = found.torn_tail;
      found.torn_tail.reset();
    }
    if (log.next_sequence > 0) expected = log.next_sequence;
    if (log.clean) continue;
    const std::string place = folder.path(name) + ", byte " + std::to_string(log.good_end);
    if (log.write_after_the_break) {
      found.damage = place + ": the bytes have changed since they were written";
    } else {
      found.torn_tail = place + ": a write that did not finish";
    }
    if (found.damage) break;
  }
  return found;
}

std::optional<TornFile> find_torn_manifest(const DataFolder& folder, const std::string& store) {
  std::string current = folder.read(store + "/CURRENT").value_or("");
  while (current.ends_with('\n')) current.pop_back();
  const std::string name = store + '/' + current;
  const std::optional<std::string> bytes = folder.read(name);
  if (current.rfind("MANIFEST-", 0) != 0 || !bytes) return std::nullopt;
  const Log manifest = inspect(*bytes, 1);
  if (manifest.clean || manifest.good_end == 0 || manifest.write_after_the_break)
    return std::nullopt;
  return TornFile{name, manifest.good_end,
                  folder.path(name) + ", byte " + std::to_string(manifest.good_end) +
                      ": a write that did not finish"};
}

Result<std::optional<std::string>> cut_torn_manifest(const DataFolder& folder,
                                                     const std::string& store) {
  const std::optional<TornFile> torn = find_torn_manifest(folder, store);
  if (!torn) return std::optional<std::string>{};
  const std::string bytes = folder.read(torn->name).value_or("");
  const Result<void> written = folder.write(torn->name, bytes.substr(0, torn->good_end));
  if (!written) return written.error();
  return std::optional(torn->what);
}

void for_each_write(std::string_view log, const std::function<void(std::string_view)>& visit) {
  inspect(log, kLeastWrite, visit);
}

}  // namespace cairn
