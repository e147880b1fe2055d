// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/optimize_picture.hpp"

#include <array>
#include <filesystem>

#include "cairn/drawing/graph_picture.hpp"
#include "cairn/drawing/ruler.hpp"
#include "clients/cli/truth.hpp"

namespace cairn::cli {
namespace {

std::string title_of(const std::vector<std::string>& inputs) {
  std::string title;
  for (const std::string& input : inputs) {
    const std::string name =
        input == "-" ? "standard input" : std::filesystem::path(input).filename().string();
    title += (title.empty() ? "" : " + ") + (name.empty() ? input : name);
  }
  return title;
}

std::string caption(const char* when, double chi2, const Result<TruthComparison>& truth) {
  std::string text = when + (": chi2 " + drawing::format_number(chi2, 10));
  if (truth) text += ", ATE " + drawing::format_length(truth->ate_rmse_m);
  return text;
}

}  // namespace

Result<void> draw_before_and_after(const BeforeAndAfter& picture, const std::string& path) {
  const auto compare = [&](const Values& values) -> Result<TruthComparison> {
    if (!picture.truth) return Error{ErrorCode::kUsage, "no truth"};
    return compare_with_truth(picture.graph, values, *picture.truth);
  };
  const Result<TruthComparison> before = compare(picture.input_values),
                                after = compare(picture.graph.values());
  const SolveSummary& summary = picture.report.summary;
  const bool has_input = picture.report.input_chi2.has_value();
  const std::array views{
      GraphView{&picture.graph, &picture.input_values,
                has_input ? caption("before", *picture.report.input_chi2, before)
                          : "before: chained edges"},
      GraphView{&picture.graph, nullptr, caption("after", summary.final_chi2, after)}};
  GraphTruth truth;
  if (after) truth = {.graph = picture.truth, .T_map_truth = after->T_map_truth};
  return draw_graphs(views, path, {.title = title_of(picture.report.inputs)}, truth,
                     picture.report.chart);
}

}  // namespace cairn::cli
