// SPDX-License-Identifier: BSD-3-Clause
// Decodes transactions and records: what is accepted encodes to the same bytes.
#include <cstdlib>

#include "cairn/journal/record.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto transaction = cairn::decode_transaction(bytes);
  if (transaction && cairn::encode(*transaction) != bytes) std::abort();
  const auto record = cairn::decode_record(bytes);
  if (!record) return 0;
  // The chain hash at the end is not decode_record's business.
  const std::string again = cairn::encode_record(record->number, record->era, record->body, {});
  if (again.substr(0, again.size() - 32) != bytes.substr(0, size - 32)) std::abort();
  return 0;
}
