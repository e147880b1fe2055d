// SPDX-License-Identifier: BSD-3-Clause
// The three files of a dlr folder, one after the other, separated by lines "===".
#include <array>

#include "cairn/io/graph_reader.hpp"
#include "tests/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  constexpr std::string_view kSeparator = "===\n";
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::array<std::string_view, 3> parts;
  for (std::string_view& part : parts) {
    const std::size_t end = rest.find(kSeparator);
    part = rest.substr(0, end);
    rest = end == std::string_view::npos ? "" : rest.substr(end + kSeparator.size());
  }
  const auto document = cairn::read_dlr_texts({{"v", parts[0]}, {"s", parts[1]}, {"e", parts[2]}});
  if (!document) return 0;
  const auto text = cairn::write_graph_text(*document, cairn::GraphFormat::kG2o);
  if (text && !document->graph.variables().empty())
    cairn::fuzz::check_text(*text, cairn::GraphFormat::kG2o);
  return 0;
}
