// SPDX-License-Identifier: BSD-3-Clause
// Decompresses the input; and compresses it and gets it back.
#include "cairn/io/compression.hpp"
#include "tests/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using cairn::Compression;
  constexpr std::size_t kLimit = std::size_t{1} << 22;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)cairn::decompress(bytes, cairn::recognize_compression(bytes), "fuzz", kLimit);
  // libbz2 takes 10 MB for whatever it compresses: now and then is enough.
  const auto compression = size % 32 == 0 ? Compression::kBzip2 : Compression::kGzip;
  const auto back =
      cairn::decompress(cairn::compress(bytes, compression), compression, "fuzz", kLimit);
  cairn::fuzz::require(back && *back == bytes, "compression loses bytes", "");
  return 0;
}
