// SPDX-License-Identifier: BSD-3-Clause
// edge show: factors of a record as they stand in the map now; edge worst: those that fit worst.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cairn/history/factor_text.hpp"
#include "cairn/history/question.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

// Places of the factors that take part with the largest chi2, the largest first.
std::vector<std::size_t> worst_factors(const PoseGraph& map, std::size_t limit) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t place = 0; place < map.factors.size(); ++place) {
    if (!takes_part(map.factors[place].state)) continue;
    const double chi2 = chi2_of(map, map.factors[place]);
    ranked.emplace_back(std::isnan(chi2) ? INFINITY : chi2, place);
  }
  limit = std::min(limit, ranked.size());
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(limit);
  std::partial_sort(ranked.begin(), end, ranked.end(), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  });
  std::vector<std::size_t> worst;
  for (auto at = ranked.begin(); at != end; ++at) worst.push_back(at->second);
  return worst;
}

// For people, or for programs.
std::string list(const PoseGraph& map, const std::vector<std::size_t>& places, bool as_json) {
  std::string text;
  Json all = Json::array();
  for (const std::size_t place : places) {
    if (as_json)
      all.push_back(json_of(map, map.factors[place]));
    else
      text += line_of(map, map.factors[place]);
  }
  return as_json ? dump(all) + '\n' : text;
}

}  // namespace

Result<std::string> answer_edge_worst(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"limit", "json"}); !known) return known.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  return list(*map, worst_factors(*map, question.number("limit", 10)), question.flag("json"));
}

Result<std::string> answer_edge_show(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"record", "json"}); !known) return known.error();
  const std::uint64_t number = question.number("record", 0);
  const Result<Record> record = find_record(asked.journal, number);
  if (!record) return record.error();
  const Result<PoseGraph> map = asked.map();
  if (!map) return map.error();
  const auto places = factors_named(std::to_string(number), *map);
  if (!places)
    return Error{ErrorCode::kUsage,
                 "record " + std::to_string(number) + " brought no factors to the map"};
  return list(*map, *places, question.flag("json"));
}

}  // namespace cairn
