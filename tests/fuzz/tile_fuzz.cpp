// SPDX-License-Identifier: BSD-3-Clause
// Decodes tiles, as they came and compressed: what is accepted encodes to the same cells.
#include <cstdlib>

#include "cairn/io/compression.hpp"
#include "idl/map_messages.hpp"

namespace {

void check(std::string_view bytes) {
  const auto tile = cairn::decode_tile(bytes);
  if (!tile) {
    if (tile.error().message.empty()) std::abort();
    return;
  }
  const auto again = cairn::decode_tile(cairn::encode(*tile));
  if (!again || *again != *tile || cairn::hash_of(*again) != cairn::hash_of(*tile)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  check(bytes);
  check(cairn::compress(bytes, cairn::Compression::kGzip));
  return 0;
}
