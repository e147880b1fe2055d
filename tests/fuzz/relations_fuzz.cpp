// SPDX-License-Identifier: BSD-3-Clause
// Reads relations, as lines and from logs with their graph; what is read is finite.
#include <cstdlib>

#include "cairn/io/relations.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto read = cairn::read_relations_text({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!read) return 0;
  if (read->relations.empty()) std::abort();
  for (const cairn::Relation& relation : read->relations)
    if (!relation.T_from_to.translation().allFinite() || relation.line == 0) std::abort();
  return 0;
}
