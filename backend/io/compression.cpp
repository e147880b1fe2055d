// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/compression.hpp"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <limits>

namespace cairn {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 17;

// Lengths in both libraries are 32 bits: they are fed piece by piece.
unsigned piece(std::size_t length) {
  return static_cast<unsigned>(std::min<std::size_t>(length, std::numeric_limits<int>::max()));
}

enum class Step { kMore, kMemberEnd, kStuck, kDamaged };

// One member at a time of either format, behind the same three calls.
class GzipDecoder {
 public:
  GzipDecoder() { ready_ = inflateInit2(&stream_, 15 + 16) == Z_OK; }  // 16: expect gzip's header
  ~GzipDecoder() { inflateEnd(&stream_); }
  GzipDecoder(const GzipDecoder&) = delete;
  GzipDecoder& operator=(const GzipDecoder&) = delete;

  void restart() { inflateReset(&stream_); }
  Step run(std::string_view& in, char*& out, std::size_t room) {
    if (!ready_) return Step::kDamaged;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));
    stream_.avail_in = piece(in.size());
    stream_.next_out = reinterpret_cast<Bytef*>(out);
    stream_.avail_out = piece(room);
    const uInt offered = stream_.avail_in;
    const int status = inflate(&stream_, Z_NO_FLUSH);
    in.remove_prefix(offered - stream_.avail_in);
    out = reinterpret_cast<char*>(stream_.next_out);
    if (status == Z_STREAM_END) return Step::kMemberEnd;
    if (status == Z_BUF_ERROR) return Step::kStuck;
    return status == Z_OK ? Step::kMore : Step::kDamaged;
  }

 private:
  z_stream stream_{};
  bool ready_;
};

class Bzip2Decoder {
 public:
  Bzip2Decoder() { restart(); }
  ~Bzip2Decoder() { BZ2_bzDecompressEnd(&stream_); }
  Bzip2Decoder(const Bzip2Decoder&) = delete;
  Bzip2Decoder& operator=(const Bzip2Decoder&) = delete;

  void restart() {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    ready_ = BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK;
  }
  Step run(std::string_view& in, char*& out, std::size_t room) {
    if (!ready_) return Step::kDamaged;
    stream_.next_in = const_cast<char*>(in.data());
    stream_.avail_in = piece(in.size());
    stream_.next_out = out;
    stream_.avail_out = piece(room);
    const unsigned offered = stream_.avail_in;
    const int status = BZ2_bzDecompress(&stream_);
    const bool moved = stream_.avail_in != offered || stream_.next_out != out;
    in.remove_prefix(offered - stream_.avail_in);
    out = stream_.next_out;
    if (status == BZ_STREAM_END) return Step::kMemberEnd;
    if (status != BZ_OK) return Step::kDamaged;
    return moved ? Step::kMore : Step::kStuck;
  }

 private:
  bz_stream stream_{};
  bool ready_ = false;
};

template <class Decoder>
Result<std::string> decode(std::string_view in, const std::string& name, std::size_t limit) {
  Decoder decoder;
  std::string text;
  bool in_member = true;
  while (in_member || !in.empty()) {
    if (!in_member) decoder.restart();
    in_member = true;
    const std::size_t size = text.size();
    if (text.capacity() < size + kChunk) text.reserve(std::max(2 * size, size + kChunk));
    text.resize(size + kChunk);
    char* out = text.data() + size;
    const Step step = decoder.run(in, out, kChunk);
    text.resize(static_cast<std::size_t>(out - text.data()));
    if (text.size() > limit) {
      return Error{ErrorCode::kBadInput,
                   "decompresses to more than " + std::to_string(limit) +
                       " bytes, half of this machine's memory; decompress and split it first",
                   name};
    }
    if (step == Step::kMemberEnd) in_member = false;
    if (step == Step::kDamaged) {
      return Error{ErrorCode::kBadInput, "the compressed data is damaged; fetch the file again",
                   name};
    }
    if (step == Step::kStuck ||
        (step == Step::kMore && in.empty() && text.size() < size + kChunk)) {
      return Error{ErrorCode::kBadInput, "the compressed data is cut short; fetch the file again",
                   name};
    }
  }
  return text;
}

std::string gzip(std::string_view text) {
  z_stream stream{};
  const bool ready = deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8,
                                  Z_DEFAULT_STRATEGY) == Z_OK;
  CAIRN_CHECK(ready, "zlib does not start");
  std::string packed;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (stream.avail_in == 0) {
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
      stream.avail_in = piece(text.size());
      text.remove_prefix(stream.avail_in);
    }
    const std::size_t size = packed.size();
    packed.resize(size + kChunk);
    stream.next_out = reinterpret_cast<Bytef*>(packed.data() + size);
    stream.avail_out = kChunk;
    status = deflate(&stream, text.empty() ? Z_FINISH : Z_NO_FLUSH);
    packed.resize(packed.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

std::string bzip2(std::string_view text) {
  bz_stream stream{};
  const bool ready = BZ2_bzCompressInit(&stream, 9, 0, 0) == BZ_OK;
  CAIRN_CHECK(ready, "libbz2 does not start");
  std::string packed;
  int status = BZ_RUN_OK;
  while (status != BZ_STREAM_END) {
    if (stream.avail_in == 0 && status == BZ_RUN_OK) {
      stream.next_in = const_cast<char*>(text.data());
      stream.avail_in = piece(text.size());
      text.remove_prefix(stream.avail_in);
    }
    const std::size_t size = packed.size();
    packed.resize(size + kChunk);
    stream.next_out = packed.data() + size;
    stream.avail_out = kChunk;
    status = BZ2_bzCompress(&stream, text.empty() ? BZ_FINISH : BZ_RUN);
    packed.resize(packed.size() - stream.avail_out);
  }
  BZ2_bzCompressEnd(&stream);
  return packed;
}

}  // namespace

Compression recognize_compression(std::string_view bytes) {
  if (bytes.starts_with("\x1F\x8B")) return Compression::kGzip;
  if (bytes.starts_with("BZh")) return Compression::kBzip2;
  return Compression::kNone;
}

Compression compression_for(std::string_view path) {
  if (path.ends_with(".gz")) return Compression::kGzip;
  if (path.ends_with(".bz2")) return Compression::kBzip2;
  return Compression::kNone;
}

Result<std::string> decompress(std::string_view bytes, Compression compression,
                               const std::string& name, std::size_t limit) {
  switch (compression) {
    case Compression::kGzip:
      return decode<GzipDecoder>(bytes, name, limit);
    case Compression::kBzip2:
      return decode<Bzip2Decoder>(bytes, name, limit);
    case Compression::kNone:
      break;
  }
  return std::string(bytes);
}

std::string compress(std::string_view text, Compression compression) {
  switch (compression) {
    case Compression::kGzip:
      return gzip(text);
    case Compression::kBzip2:
      return bzip2(text);
    case Compression::kNone:
      break;
  }
  return std::string(text);
}

}  // namespace cairn
