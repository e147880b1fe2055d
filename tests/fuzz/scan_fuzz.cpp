// SPDX-License-Identifier: BSD-3-Clause
// Decodes scans; what is accepted encodes to the same bytes.
#include <cstdlib>

#include "cairn/maps/range_scan.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto scan = cairn::decode_range_scan(bytes);
  if (!scan) return 0;
  const auto again = cairn::encode(*scan);
  if (!again || *again != bytes) std::abort();
  return 0;
}
