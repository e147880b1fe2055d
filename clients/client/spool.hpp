// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

struct SpoolOptions {
  std::filesystem::path folder;
  std::string source;                     ///< a spool belongs to one
  std::uint64_t most_bytes = 1ull << 30;  ///< on disk; beyond, append() says "spool full"
};

/// A client's transactions on disk, so that neither its death nor the daemon's loses one. Records
/// are numbered 1, 2, 3, ... in the spool's random epoch. One process at a time (lock file).
/// Format: README.md. One thread at a time.
class Spool {
 public:
  /// Opens or makes the folder. A torn end of the newest file is cut off: what was in it was never
  /// reported as kept. kUsage where the folder is taken or another source's, kBadInput (file:byte)
  /// where it is damaged: whole records follow one that is not, and nothing is cut.
  static Result<Spool> open(SpoolOptions options);
  Spool(Spool&& other) noexcept;
  Spool& operator=(Spool&&) = delete;
  ~Spool();

  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }
  [[nodiscard]] std::uint64_t next_sequence() const { return next_; }
  /// The first sequence that read() can still find; next_sequence() where there is none.
  [[nodiscard]] std::uint64_t oldest_kept() const { return segments_.front().first; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  /// What a record of this length takes on disk.
  [[nodiscard]] static std::uint64_t bytes_of(std::string_view record);

  /// Gives the records the next sequences and returns when they are on disk; all or, with an error,
  /// none of them.
  Result<void> append(const std::vector<std::string>& records);
  /// Quickest in ascending order.
  Result<std::string> read(std::uint64_t sequence);
  /// What the daemon has said to this spool: the highest sequence that has a receipt, and that
  /// receipt's revision. After a power loss it may be older, or nothing.
  struct Promise {
    Revision revision{};
    std::uint64_t sequence = 0;

    friend bool operator==(const Promise&, const Promise&) = default;
  };
  [[nodiscard]] Promise promise() const;
  void remember(const Promise& promise);
  /// Sequences up to this one are in the daemon's store. They are kept while the spool is less than
  /// half full, in case the store loses its tail.
  void release(std::uint64_t decided);

 private:
  struct Segment {
    std::uint64_t first;  ///< sequence; also the file's name
    std::uint64_t bytes;
  };
  struct Cursor {
    std::uint64_t segment = 0;  ///< its first sequence; 0: nowhere
    std::uint64_t sequence = 0;
    std::uint64_t offset = 0;
    int file = -1;
  };

  explicit Spool(SpoolOptions options) : options_(std::move(options)) {}
  Result<void> lock();
  Result<void> identify();
  Result<void> find_segments();
  Result<void> scan_newest();
  Result<void> start_segment();
  [[nodiscard]] std::uint64_t segment_bytes() const;
  Result<void> write_all(std::string_view bytes);
  void write_zeros(std::uint64_t offset);
  void cut_zeros();
  Error take_back(Error error);
  Result<void> seek(std::uint64_t sequence);
  [[nodiscard]] std::filesystem::path path_of(std::uint64_t first) const;
  [[nodiscard]] Error failure(const std::string& what) const;
  [[nodiscard]] Error damage(const Cursor& at, const std::string& detail) const;

  SpoolOptions options_;
  std::uint64_t epoch_ = 0;
  std::uint64_t next_ = 1;
  std::uint64_t bytes_ = 0;
  std::vector<Segment> segments_;  // ascending; the last one is written to
  int lock_file_ = -1;
  int segment_file_ = -1;
  std::uint64_t zeros_end_ = 0;  // of the newest file: up to here it need not grow
  Cursor cursor_;
  std::optional<Error> broken_;  // nothing is known about the end of the newest file
};

}  // namespace cairn
