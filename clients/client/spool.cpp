// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/spool.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <utility>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSegmentBytes = 8u << 20;
constexpr std::uint64_t kZerosBytes = 1u << 20;        // written ahead at a time
constexpr std::uint64_t kHead = 16;                    // of a record
constexpr std::uint32_t kMostRecordBytes = 64u << 20;  // a longer length is damage
constexpr char kExtension[] = ".spool";

// Head of a record, little-endian: length of the bytes, CRC-32 of sequence and bytes, sequence.
using Head = std::array<unsigned char, kHead>;

template <class Integer>
void put(unsigned char* to, Integer value) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    to[i] = static_cast<unsigned char>(value >> (8 * i));
}
template <class Integer>
Integer get(const unsigned char* from) {
  Integer value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i) value |= static_cast<Integer>(from[i]) << (8 * i);
  return value;
}

std::uint32_t checksum(const unsigned char* sequence, std::string_view bytes) {
  const uLong seed = crc32(0, sequence, 8);
  return static_cast<std::uint32_t>(
      crc32(seed, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

void append_record(std::string& to, std::uint64_t sequence, std::string_view bytes) {
  Head head;
  put(head.data(), static_cast<std::uint32_t>(bytes.size()));
  put(head.data() + 8, sequence);
  put(head.data() + 4, checksum(head.data() + 8, bytes));
  to.append(reinterpret_cast<const char*>(head.data()), head.size());
  to.append(bytes);
}

bool read_fully(int file, void* to, std::size_t count, std::uint64_t offset) {
  auto* at = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = pread(file, at, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    offset += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

// The record at `offset`, if it is whole and the one that is expected there.
std::optional<std::string> read_record(int file, std::uint64_t offset, std::uint64_t sequence) {
  Head head;
  if (!read_fully(file, head.data(), head.size(), offset)) return std::nullopt;
  const auto length = get<std::uint32_t>(head.data());
  if (length > kMostRecordBytes || get<std::uint64_t>(head.data() + 8) != sequence)
    return std::nullopt;
  std::string bytes(length, '\0');
  if (!read_fully(file, bytes.data(), length, offset + kHead)) return std::nullopt;
  if (checksum(head.data() + 8, bytes) != get<std::uint32_t>(head.data() + 4)) return std::nullopt;
  return bytes;
}

// Whether a whole record of this sequence or a later one begins behind `offset`.
bool has_record_behind(int file, std::uint64_t offset, std::uint64_t end, std::uint64_t sequence) {
  std::string rest(end - offset, '\0');
  if (!read_fully(file, rest.data(), rest.size(), offset)) return false;
  const std::uint64_t last = sequence + rest.size() / kHead;
  for (std::size_t at = 1; at + kHead <= rest.size(); ++at) {
    const auto* head = reinterpret_cast<const unsigned char*>(rest.data()) + at;
    const auto found = get<std::uint64_t>(head + 8);
    if (found < sequence || found > last) continue;
    const auto length = get<std::uint32_t>(head);
    if (length > rest.size() - at - kHead) continue;
    const std::string_view bytes(rest.data() + at + kHead, length);
    if (checksum(head + 8, bytes) == get<std::uint32_t>(head + 4)) return true;
  }
  return false;
}

void sync_folder(const fs::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)fsync(file);  // file systems that cannot sync folders say so here
  close(file);
}

void close_file(int& file) {
  if (file >= 0) close(file);
  file = -1;
}

}  // namespace

std::uint64_t Spool::bytes_of(std::string_view record) { return kHead + record.size(); }

fs::path Spool::path_of(std::uint64_t first) const {
  char name[32];
  std::snprintf(name, sizeof name, "%020llu%s", static_cast<unsigned long long>(first), kExtension);
  return options_.folder / name;
}

Error Spool::failure(const std::string& what) const {
  return {ErrorCode::kInternal, what + ": " + std::strerror(errno), options_.folder.string()};
}

Error Spool::damage(const Cursor& at, const std::string& detail) const {
  return {ErrorCode::kBadInput,
          "sequence " + std::to_string(at.sequence) + " is damaged (length or checksum)" + detail +
              "; move the folder away to begin anew",
          path_of(at.segment).string() + ':' + std::to_string(at.offset)};
}

Spool::Spool(Spool&& other) noexcept
    : options_(std::move(other.options_)),
      epoch_(other.epoch_),
      next_(other.next_),
      bytes_(other.bytes_),
      segments_(std::move(other.segments_)),
      lock_file_(std::exchange(other.lock_file_, -1)),
      segment_file_(std::exchange(other.segment_file_, -1)),
      zeros_end_(other.zeros_end_),
      cursor_(std::exchange(other.cursor_, {})),
      broken_(std::move(other.broken_)) {}

Spool::~Spool() {
  if (!broken_) cut_zeros();
  close_file(cursor_.file);
  close_file(segment_file_);
  close_file(lock_file_);
}

Result<Spool> Spool::open(SpoolOptions options) {
  Spool spool(std::move(options));
  std::error_code failed;
  fs::create_directories(spool.options_.folder, failed);
  if (failed)
    return Error{ErrorCode::kUsage, "cannot make the spool folder: " + failed.message(),
                 spool.options_.folder.string()};
  if (auto ok = spool.lock(); !ok) return ok.error();
  if (auto ok = spool.identify(); !ok) return ok.error();
  if (auto ok = spool.find_segments(); !ok) return ok.error();
  if (auto ok = spool.scan_newest(); !ok) return ok.error();
  return spool;
}

Result<void> Spool::lock() {
  lock_file_ = ::open((options_.folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_file_ < 0) return failure("cannot open the lock file");
  if (flock(lock_file_, LOCK_EX | LOCK_NB) == 0) return {};
  return Error{ErrorCode::kUsage,
               "the spool is in use by another process; end it, or choose another folder",
               options_.folder.string()};
}

// The file says: "cairn-spool 1", then source and epoch.
Result<void> Spool::identify() {
  const fs::path path = options_.folder / "identity";
  if (std::ifstream in(path); in) {
    std::string magic, source;
    int version = 0;
    in >> magic >> version >> epoch_;
    std::getline(in >> std::ws, source);
    if (!in || magic != "cairn-spool" || version != 1)
      return Error{ErrorCode::kBadInput,
                   "not a spool of this version; expected \"cairn-spool 1 EPOCH SOURCE\"",
                   path.string()};
    if (source == options_.source) return {};
    return Error{ErrorCode::kUsage,
                 "the spool belongs to source \"" + source + "\", not \"" + options_.source +
                     "\"; choose another folder",
                 path.string()};
  }
  std::random_device random;
  while (epoch_ == 0) epoch_ = std::uint64_t{random()} << 32 | random();
  const fs::path temporary = path.string() + ".new";
  const std::string text = "cairn-spool 1 " + std::to_string(epoch_) + ' ' + options_.source + '\n';
  int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const bool written = file >= 0 &&
                       write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       fsync(file) == 0;
  close_file(file);
  if (!written || std::rename(temporary.c_str(), path.c_str()) != 0)
    return failure("cannot write the spool's identity");
  sync_folder(options_.folder);
  return {};
}

Result<void> Spool::find_segments() {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(options_.folder, failed)) {
    if (entry.path().extension() != kExtension) continue;
    const std::string stem = entry.path().stem().string();
    if (stem.size() != 20 || stem.find_first_not_of("0123456789") != std::string::npos) continue;
    segments_.push_back({.first = std::stoull(stem), .bytes = entry.file_size()});
  }
  if (failed)
    return Error{ErrorCode::kUsage, "cannot read the spool folder: " + failed.message(),
                 options_.folder.string()};
  std::sort(segments_.begin(), segments_.end(),
            [](const Segment& a, const Segment& b) { return a.first < b.first; });
  for (const Segment& segment : segments_) bytes_ += segment.bytes;
  if (segments_.empty()) return start_segment();
  segment_file_ = ::open(path_of(segments_.back().first).c_str(), O_RDWR | O_CLOEXEC);
  return segment_file_ < 0 ? failure("cannot open the newest spool file") : Result<void>();
}

// Finds the next sequence, and cuts off what a crash left half written: nothing whole follows it.
Result<void> Spool::scan_newest() {
  Segment& newest = segments_.back();
  next_ = newest.first;
  std::uint64_t offset = 0;
  while (const auto record = read_record(segment_file_, offset, next_)) {
    offset += bytes_of(*record);
    ++next_;
  }
  zeros_end_ = offset;
  if (offset == newest.bytes) return {};
  if (has_record_behind(segment_file_, offset, newest.bytes, next_))
    return damage({.segment = newest.first, .sequence = next_, .offset = offset},
                  ", and whole records that may wait for the daemon follow it");
  if (ftruncate(segment_file_, static_cast<off_t>(offset)) != 0 || fsync(segment_file_) != 0)
    return failure("cannot cut off the torn end of the spool");
  bytes_ -= newest.bytes - offset;
  newest.bytes = offset;
  return {};
}

Result<void> Spool::start_segment() {
  const int file = ::open(path_of(next_).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0) return failure("cannot make a spool file");
  sync_folder(options_.folder);
  cut_zeros();
  close_file(segment_file_);
  segment_file_ = file;
  segments_.push_back({.first = next_, .bytes = 0});
  zeros_end_ = 0;
  return {};
}

std::uint64_t Spool::segment_bytes() const {
  return std::min(kSegmentBytes, options_.most_bytes / 8);
}

Result<void> Spool::append(const std::vector<std::string>& records) {
  if (broken_) return *broken_;
  if (records.empty()) return {};
  std::string bytes;
  std::uint64_t sequence = next_;
  for (const std::string& record : records) append_record(bytes, sequence++, record);
  if (bytes_ + bytes.size() > options_.most_bytes)
    return Error{ErrorCode::kNotUsable,
                 "spool full: " + std::to_string(bytes_) + " of " +
                     std::to_string(options_.most_bytes) +
                     " bytes wait for the daemon; is it running?",
                 options_.folder.string()};
  if (segments_.back().bytes > 0 && segments_.back().bytes + bytes.size() > segment_bytes())
    if (auto ok = start_segment(); !ok) return ok;
  if (auto ok = write_all(bytes); !ok) return ok;
  segments_.back().bytes += bytes.size();
  bytes_ += bytes.size();
  next_ = sequence;
  return {};
}

Result<void> Spool::write_all(std::string_view bytes) {
  auto offset = segments_.back().bytes;
  for (std::string_view rest = bytes; !rest.empty();) {
    const ssize_t count =
        pwrite(segment_file_, rest.data(), rest.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return take_back(failure("cannot write the spool"));
    offset += static_cast<std::uint64_t>(count);
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  if (offset > zeros_end_) write_zeros(offset);
  if (fdatasync(segment_file_) == 0) return {};
  return take_back(failure("the disk did not keep the spool (fdatasync)"));
}

// A file that need not grow is synced with one write of the disk and not three. Where there is no
// room, it grows.
void Spool::write_zeros(std::uint64_t offset) {
  const std::uint64_t end = std::min(offset + kZerosBytes, segment_bytes());
  zeros_end_ = std::max(offset, end);
  if (offset >= end) return;
  const std::string zeros(end - offset, '\0');
  (void)!pwrite(segment_file_, zeros.data(), zeros.size(), static_cast<off_t>(offset));
}

// A file is as long as what is in it, once nothing is added.
void Spool::cut_zeros() {
  if (segment_file_ >= 0)
    (void)!ftruncate(segment_file_, static_cast<off_t>(segments_.back().bytes));
}

// Of what could not be appended nothing may be found, and sent, by the next run.
Error Spool::take_back(Error error) {
  zeros_end_ = 0;
  if (ftruncate(segment_file_, static_cast<off_t>(segments_.back().bytes)) == 0 &&
      fdatasync(segment_file_) == 0)
    return error;
  error.message += "; it could not be taken back either, and may be sent after a restart";
  broken_ = error;
  return error;
}

Result<void> Spool::seek(std::uint64_t sequence) {
  auto after = std::upper_bound(segments_.begin(), segments_.end(), sequence,
                                [](std::uint64_t s, const Segment& g) { return s < g.first; });
  if (after == segments_.begin() || sequence >= next_)
    return Error{ErrorCode::kUsage,
                 "the spool keeps sequences " + std::to_string(oldest_kept()) + " to " +
                     std::to_string(next_ - 1) + ", not " + std::to_string(sequence),
                 options_.folder.string()};
  const std::uint64_t first = std::prev(after)->first;
  if (cursor_.segment == first && cursor_.sequence <= sequence) return {};
  close_file(cursor_.file);
  const int file = ::open(path_of(first).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return failure("cannot open a spool file");
  cursor_ = {.segment = first, .sequence = first, .offset = 0, .file = file};
  return {};
}

Result<std::string> Spool::read(std::uint64_t sequence) {
  if (auto ok = seek(sequence); !ok) return ok.error();
  for (;;) {
    auto record = read_record(cursor_.file, cursor_.offset, cursor_.sequence);
    if (!record) return damage(cursor_, "");
    cursor_.offset += bytes_of(*record);
    if (cursor_.sequence++ == sequence) return std::move(*record);
  }
}

Spool::Promise Spool::promise() const {
  std::ifstream in(options_.folder / "promise");
  std::string magic, end;
  int version = 0;
  Promise promise;
  Revision& revision = promise.revision;
  in >> magic >> version >> revision.store >> revision.era >> revision.number >> promise.sequence >>
      end;
  return in && magic == "cairn-promise" && version == 1 && end == "end" ? promise : Promise();
}

// Not synced: only a power loss of both sides at once needs it, and that may take the last second.
void Spool::remember(const Promise& promise) {
  const fs::path path = options_.folder / "promise";
  const fs::path temporary = path.string() + ".new";
  {
    std::ofstream out(temporary, std::ios::trunc);
    const Revision& revision = promise.revision;
    out << "cairn-promise 1 " << revision.store << ' ' << revision.era << ' ' << revision.number
        << ' ' << promise.sequence << " end\n";
    if (!out.flush()) return;
  }
  std::error_code ignored;
  fs::rename(temporary, path, ignored);
}

void Spool::release(std::uint64_t decided) {
  bool removed = false;
  while (segments_.size() > 1 && segments_[1].first <= decided + 1 &&
         bytes_ > options_.most_bytes / 2) {
    std::error_code ignored;  // a file that stays is found and dropped at the next start
    fs::remove(path_of(segments_.front().first), ignored);
    bytes_ -= segments_.front().bytes;
    segments_.erase(segments_.begin());
    removed = true;
  }
  if (removed) sync_folder(options_.folder);
}

}  // namespace cairn
