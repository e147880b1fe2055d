// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/drawing/trajectory_picture.hpp"
#include "cairn/evaluation/association.hpp"
#include "cairn/evaluation/trajectory_error.hpp"
#include "clients/cli/choices.hpp"
#include "clients/cli/eval.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

const Choices<Metric> kMetrics{
    {"ate", Metric::kAte}, {"rpe", Metric::kRpe}, {"relations", Metric::kRelations}};
const Choices<std::optional<AlignmentKind>> kAlignments{{"none", AlignmentKind::kNone},
                                                        {"se3", AlignmentKind::kSe3},
                                                        {"sim3", AlignmentKind::kSim3},
                                                        {"yaw", AlignmentKind::kYaw}};

std::string metric_name(const EvalArguments& a) {
  for (const auto& [name, metric] : kMetrics) {
    if (metric == a.metric) return name;
  }
  return {};
}

AlignmentKind alignment_of(const EvalArguments& a) {
  return a.align.value_or(a.metric == Metric::kAte ? AlignmentKind::kSe3 : AlignmentKind::kNone);
}

std::string alignment_name(const EvalArguments& a) {
  for (const auto& [name, kind] : kAlignments) {
    if (kind == alignment_of(a)) return name;
  }
  return {};
}

struct Evaluation {
  std::size_t unmatched = 0;
  Association matches;  // the estimate is aligned
  PoseErrors errors{};
  Statistics translation_m{}, rotation_deg{};
};

// "10m" is a length of path, "5" a number of poses.
Result<PairSpacing> parse_spacing(const EvalArguments& a) {
  const bool in_metres = a.delta.ends_with('m');
  const char* end = a.delta.data() + a.delta.size() - (in_metres ? 1 : 0);
  double value = 0.0;
  const auto [rest, status] = std::from_chars(a.delta.data(), end, value);
  const bool whole = in_metres || value == std::floor(value);
  if (status != std::errc() || rest != end || !std::isfinite(value) || value <= 0.0 || !whole) {
    return Error{
        ErrorCode::kUsage,
        "'" + a.delta + "' is no spacing; write a length like 10m or a number of poses like 5",
        "--delta"};
  }
  return PairSpacing{.delta = value, .in_metres = in_metres, .consecutive = a.consecutive};
}

void warn_about(const Trajectory& trajectory) {
  for (const std::string& warning : trajectory.warnings) Console::warn(warning);
}

Result<void> find_errors(const EvalArguments& a, const PairSpacing& spacing, Evaluation& e) {
  if (a.metric == Metric::kAte) {
    e.errors = absolute_errors(e.matches.reference, e.matches.estimate);
  } else {
    e.errors = relative_errors(e.matches.reference, e.matches.estimate,
                               choose_pairs(e.matches.estimate, spacing));
    if (e.errors.at.empty()) {
      return Error{ErrorCode::kBadInput,
                   "the matched poses are too few or too close together for a pair " + a.delta +
                       " apart; give a smaller --delta",
                   a.estimate};
    }
  }
  e.translation_m = compute_statistics(e.errors.translation_m);
  e.rotation_deg = compute_statistics(e.errors.rotation_deg);
  return {};
}

Result<Evaluation> evaluate(const EvalArguments& a, const PairSpacing& spacing) {
  const Result<Trajectory> reference = read_trajectory(a.reference);
  if (!reference) return reference.error();
  const Result<Trajectory> estimate = read_trajectory(a.estimate);
  if (!estimate) return estimate.error();
  warn_about(*reference);
  warn_about(*estimate);
  Result<Association> matches =
      associate(*reference, *estimate, a.max_difference_ns(kDefaultMaxDifferenceNs));
  if (!matches) return matches.error();

  Evaluation e{.unmatched = matches->unmatched, .matches = std::move(*matches)};
  const bool planar = reference->planar && estimate->planar;
  const Alignment alignment =
      align(alignment_of(a), e.matches.reference, e.matches.estimate, planar);
  if (!alignment.rotation_determined) {
    Console::warn(
        "the matched positions lie on a line, so they do not tell the whole rotation of the "
        "alignment; "
        "the smallest was taken");
  }
  for (Se3& T : e.matches.estimate) T = alignment * T;
  if (Result<void> found = find_errors(a, spacing, e); !found) return found.error();
  return e;
}

void print_table(const EvalArguments& a, const Evaluation& e) {
  const Console console(a.json == "-" || a.plot == "-", a.quiet);
  const bool absolute = a.metric == Metric::kAte;
  std::string title =
      absolute ? "absolute trajectory error" : "relative pose error over " + a.delta;
  title += ", aligned by " + alignment_name(a) + ": " + std::to_string(e.errors.at.size()) +
           (absolute        ? " poses, "
            : a.consecutive ? " consecutive pairs, "
                            : " pairs, ") +
           std::to_string(e.unmatched) + " unmatched";
  console.say(title);
  print_statistics(console, e.translation_m, e.rotation_deg);
}

std::string json_text(const EvalArguments& a, const Evaluation& e) {
  nlohmann::ordered_json json;
  json["metric"] = metric_name(a);
  json["align"] = alignment_name(a);
  json["pairs"] = e.errors.at.size();
  json["unmatched"] = e.unmatched;
  json["translation"] = json_of(e.translation_m);
  json["rotation"] = json_of(e.rotation_deg);
  return json.dump(2) + "\n";
}

Result<void> draw(const EvalArguments& a, const Evaluation& e) {
  TrajectoryErrors picture;
  for (const Se3& T : e.matches.reference) picture.reference.push_back(T.translation());
  for (const Se3& T : e.matches.estimate) picture.estimate.push_back(T.translation());
  const std::vector<double> path_m = path_lengths(e.matches.reference);
  for (const std::size_t pose : e.errors.at) picture.path_m.push_back(path_m[pose]);
  picture.index = e.errors.at;
  picture.error = e.errors.translation_m;
  if (a.metric == Metric::kRpe) picture.error_label = "position error over " + a.delta + " [m]";
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "rmse %.4g m, median %.4g m, max %.4g m, aligned by %s",
                e.translation_m.rmse, e.translation_m.median, e.translation_m.max,
                alignment_name(a).c_str());
  picture.summary = numbers;
  const std::string title = std::filesystem::path(a.estimate).filename().string() + " against " +
                            std::filesystem::path(a.reference).filename().string();
  return draw_trajectory_errors(picture, a.plot, {.title = title});
}

Result<void> check_relation_options(const EvalArguments& a) {
  const bool relations = a.metric == Metric::kRelations;
  if (relations && a.align)
    return Error{ErrorCode::kUsage, "relations do not depend on the frame; leave out --align"};
  if (relations && !a.plot.empty())
    return Error{ErrorCode::kUsage, "relations have no picture; leave out --plot"};
  if (!relations && (a.worst > 0 || a.strict))
    return Error{ErrorCode::kUsage, "--worst and --strict belong to relations"};
  return {};
}

Result<void> check_arguments(const EvalArguments& a) {
  if (a.reference == "-" && a.estimate == "-") {
    return Error{ErrorCode::kUsage, "standard input ('-') can be read only once"};
  }
  if (a.metric != Metric::kRpe && a.asks_for_pairs) {
    return Error{ErrorCode::kUsage,
                 metric_name(a) + " takes every error; --delta and --pairs belong to rpe"};
  }
  if (Result<void> fits = check_relation_options(a); !fits) return fits;
  if (const double s = a.max_difference_s.value_or(0.0); !(s >= 0.0 && s <= 1e9)) {
    return Error{ErrorCode::kUsage, "seconds from 0 to 1e9 are expected", "--max-difference"};
  }
  if (!a.plot.empty()) {
    if (Result<void> picture = check_picture(a.plot); !picture) return picture;
  }
  return check_outputs({a.json, a.plot});
}

int run_eval(const EvalArguments& a) {
  if (Result<void> sound = check_arguments(a); !sound) return fail(sound.error());
  if (a.metric == Metric::kRelations) return run_relations(a);
  const Result<PairSpacing> spacing = parse_spacing(a);
  if (!spacing) return fail(spacing.error());
  const Result<Evaluation> evaluation = evaluate(a, *spacing);
  if (!evaluation) return fail(evaluation.error());
  Result<void> written;
  if (!a.plot.empty()) written = draw(a, *evaluation);
  if (written && !a.json.empty()) written = write_file(a.json, json_text(a, *evaluation));
  if (!written) return fail(written.error());
  print_table(a, *evaluation);
  return kDone;
}

}  // namespace

std::uint64_t EvalArguments::max_difference_ns(std::uint64_t otherwise) const {
  return max_difference_s ? static_cast<std::uint64_t>(std::llround(1e9 * *max_difference_s))
                          : otherwise;
}

void print_statistics(const Console& console, const Statistics& translation_m,
                      const Statistics& rotation_deg) {
  char line[160];
  std::snprintf(line, sizeof line, "%-16s%13s%13s%13s%13s%13s%13s", "", "mean", "std", "rmse",
                "median", "min", "max");
  console.say(line);
  const auto print_row = [&](const char* label, const Statistics& s) {
    std::snprintf(line, sizeof line, "%-16s%13.7f%13.7f%13.7f%13.7f%13.7f%13.7f", label, s.mean,
                  s.standard_deviation, s.rmse, s.median, s.min, s.max);
    console.say(line);
  };
  print_row("translation [m]", translation_m);
  print_row("rotation [deg]", rotation_deg);
}

nlohmann::ordered_json json_of(const Statistics& s) {
  return {{"mean", s.mean}, {"std", s.standard_deviation},
          {"rmse", s.rmse}, {"median", s.median},
          {"min", s.min},   {"max", s.max}};
}

Run add_eval(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<EvalArguments>();
  verb = parent.add_subcommand("eval", "measure the error of a trajectory against a reference");
  add_choice(
      *verb, "METRIC", a->metric, kMetrics,
      "ate: error of every pose; rpe: error of the motion between pairs of poses; relations: "
      "error of the motions that the reference lists")
      ->required();
  verb->add_option(
          "REFERENCE", a->reference,
          "the truth: a TUM, KITTI or graph file; for relations lines t1 t2 x y z roll pitch "
          "yaw, or a log with its graph")
      ->required()
      ->type_name("FILE");
  verb->add_option("ESTIMATE", a->estimate, "what is judged, in the same format (relations: TUM)")
      ->required()
      ->type_name("FILE");
  add_choice(*verb, "--align", a->align, kAlignments,
             "fit the estimate to the reference first (by default se3 for ate, none for rpe)");
  verb->add_option("--delta", a->delta,
                   "rpe: distance of a pair, as length of path (10m) or number of poses (5)");
  add_choice(*verb, "--pairs", a->consecutive, {{"consecutive", true}, {"all", false}},
             "rpe: pairs that follow each other, or one from every pose");
  verb->add_option("--max-difference", a->max_difference_s,
                   "seconds between time stamps of one pose (TUM): by default 0.01, for relations "
                   "0.000001")
      ->type_name("S");
  verb->add_option("--worst", a->worst, "relations: list the N with the largest errors")
      ->type_name("N");
  verb->add_flag("--strict", a->strict, "relations: exit code 4 when one lacks a pose");
  verb->add_option("--json", a->json, "write the numbers as JSON; '-' is standard output")
      ->type_name("FILE");
  verb->add_option("--plot", a->plot, "draw both trajectories and the error along the path")
      ->type_name("OUT.svg|OUT.png");
  verb->add_flag("--quiet", a->quiet, "print nothing");
  verb->footer(
      "Poses are matched by time stamp (TUM), by line (KITTI) or by id (graph files); relations "
      "always "
      "by time stamp. '-' reads one of the files from standard input.");
  return [a, verb] {
    a->asks_for_pairs = verb->count("--delta") + verb->count("--pairs") > 0;
    return run_eval(*a);
  };
}

}  // namespace cairn::cli
