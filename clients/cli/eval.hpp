// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "clients/cli/console.hpp"

namespace cairn::cli {

enum class Metric { kAte, kRpe, kRelations };

/// Of `cairn eval`.
struct EvalArguments {
  Metric metric = Metric::kAte;
  std::string reference, estimate;
  std::optional<AlignmentKind> align;
  std::string delta = "10m";
  bool consecutive = true;
  std::optional<double> max_difference_s;
  std::size_t worst = 0;
  bool strict = false;
  std::string json, plot;
  bool asks_for_pairs = false;
  bool quiet = false;

  /// Between the stamps of one pose.
  [[nodiscard]] std::uint64_t max_difference_ns(std::uint64_t otherwise) const;
};

/// The head of a table of errors, and its two rows.
void print_statistics(const Console& console, const Statistics& translation_m,
                      const Statistics& rotation_deg);

/// `{mean, std, rmse, median, min, max}`.
nlohmann::ordered_json json_of(const Statistics& s);

/// The metric `relations`, from reading to printing; the exit code.
int run_relations(const EvalArguments& a);

}  // namespace cairn::cli
