// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  cairn::fuzz::check_text({reinterpret_cast<const char*>(data), size}, cairn::GraphFormat::kIsam);
  return 0;
}
