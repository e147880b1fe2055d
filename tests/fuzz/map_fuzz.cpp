// SPDX-License-Identifier: BSD-3-Clause
// Reads a map: a YAML file and, from its first "P2" or "P5" on, a PGM. What is read is written and
// read again.
#include <algorithm>
#include <cstdlib>

#include "cairn/io/map_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = std::min({all.find("P2"), all.find("P5"), size});
  const auto yaml = cairn::read_map_yaml(all.substr(0, cut), "fuzz");
  if (!yaml) return 0;
  const auto map = cairn::read_pgm(all.substr(cut), "fuzz", *yaml);
  if (!map) return 0;
  const auto written = cairn::write_map_yaml(*map, "fuzz.pgm");
  if (!written) std::abort();
  const auto yaml_again = cairn::read_map_yaml(*written, "again");
  if (!yaml_again) std::abort();
  const auto again = cairn::read_pgm(cairn::write_pgm(*map), "again", *yaml_again);
  if (!again || again->cells != map->cells || again->width != map->width) std::abort();
  return 0;
}
