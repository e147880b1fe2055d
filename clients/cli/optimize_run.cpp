// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <thread>

#include "cairn/core/exit_code.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/core/stopwatch.hpp"
#include "cairn/solver/optimize.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/covariances.hpp"
#include "clients/cli/interrupt.hpp"
#include "clients/cli/optimize.hpp"
#include "clients/cli/optimize_picture.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/summary.hpp"
#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

Result<SolveOptions> solve_options(const OptimizeArguments& a) {
  SolveOptions options = a.solve;
  Result<RobustLoss> loss = RobustLoss::parse(a.loss);
  if (!loss) return Error{loss.error().code, loss.error().message, "--loss"};
  options.loss = *loss;
  if (!is_available(options.linear)) {
    return Error{ErrorCode::kUsage,
                 "this build has no " + std::string(to_string(options.linear)) +
                     " back-end; choose another, or build with -DCAIRN_WITH_CERES=ON",
                 "--linear"};
  }
  if (!is_runnable(options.kernel)) {
    return Error{ErrorCode::kUsage,
                 "this processor cannot run that kernel; leave it out, or choose portable",
                 "--kernel"};
  }
  if (a.gate && options.loss.kind() != RobustLoss::Kind::kNone)
    return Error{ErrorCode::kUsage, "the gate weighs loops itself; choose --gate or --loss",
                 "--gate"};
  if (options.threads == 0)
    options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return options;
}

Result<void> check_arguments(const OptimizeArguments& a) {
  if (std::count(a.inputs.begin(), a.inputs.end(), "-") + (a.truth == "-" ? 1 : 0) > 1) {
    return Error{ErrorCode::kUsage, "standard input ('-') can be read only once"};
  }
  std::vector<std::string> outputs{a.output, a.json, a.covariances};
  for (const std::string& plot : a.plots) {
    if (Result<void> picture = check_picture(plot); !picture) return picture;
    outputs.push_back(plot);
  }
  return check_outputs(outputs);
}

// The graph with what is reported about it, before and after.
struct Job {
  GraphDocument document;
  Values input_values{};  ///< kept where a picture or the truth needs them
  std::optional<Graph> truth{};
  OptimizeReport report{};
};

Result<Job> read_job(const OptimizeArguments& a) {
  const Stopwatch watch;
  Result<GraphDocument> document = read_graphs(a.inputs, {.format = a.format, .strict = a.strict});
  if (!document) return document.error();
  Job job{.document = std::move(*document)};
  job.report = {.inputs = a.inputs,
                .vertices = job.document.graph.variables().size(),
                .edges = job.document.graph.factor_count(),
                .chart = a.solve.chart,
                .read_s = watch.seconds()};
  const std::vector<bool>& has_start = job.document.has_start;
  if (std::find(has_start.begin(), has_start.end(), true) != has_start.end()) {
    job.report.input_chi2 = compute_chi2(job.document.graph, a.solve.chart);
  }
  if (!a.plots.empty() || !a.truth.empty()) job.input_values = job.document.graph.values();
  if (a.truth.empty()) return job;
  Result<GraphDocument> truth = read_graph(a.truth);
  if (!truth) return truth.error();
  job.truth = std::move(truth->graph);
  return job;
}

// Names what was left out, and takes it out of the graph.
GateReport take_out(Graph& graph, const GatedSolution& solution) {
  GateReport report{.loops = solution.loops, .noise_scale = solution.noise_scale};
  std::vector<bool> kept(graph.factor_count(), true);
  for (const LeftOutLoop& loop : solution.left_out) {
    kept[loop.factor] = false;
    const std::vector<VariableSlot> ends = graph.slots_of(graph.factors()[loop.factor]);
    report.left_out.push_back({graph.variables()[ends[0]].id, graph.variables()[ends[1]].id, loop});
  }
  if (!solution.left_out.empty()) graph = graph.with_factors(kept);
  return report;
}

void solve(Job& job, SolveOptions options, bool gate, const Console& console) {
  Graph& graph = job.document.graph;
  const Stopwatch watch;
  console.show_progress("initializing");
  options.on_iteration = [&](int iteration, const IterationReport& report) {
    console.show_progress(progress_line(iteration, report, watch.seconds()));
    return !InterruptGuard::interrupted();
  };
  if (gate) {
    const GatedSolution solution = solve_gated(graph, options);
    job.report.summary = solution.summary;
    if (solution.summary.usable()) job.report.gate = take_out(graph, solution);
  } else {
    job.report.summary = optimize(graph, options);
  }
  console.clear_progress();
}

Result<void> write_results(const OptimizeArguments& a, const SolveOptions& options, Job& job,
                           const Console& console) {
  if (!a.covariances.empty()) {
    const Result<std::string> text = covariance_text(job.document.graph, options);
    if (!text) return text.error();
    if (Result<void> written = write_file(a.covariances, *text); !written) return written;
    console.say("covariances:   " + a.covariances);
  }
  for (const std::string& plot : a.plots) {
    const Graph* truth = job.truth ? &*job.truth : nullptr;
    const BeforeAndAfter picture{job.document.graph, job.input_values, job.report, truth};
    if (Result<void> drawn = draw_before_and_after(picture, plot); !drawn) return drawn;
    console.say("picture:       " + plot);
  }
  if (!a.output.empty()) {
    const Stopwatch watch;
    Result<void> written = write_graph(job.document, a.output, output_format(a.to, a.output));
    if (!written) return written;
    job.report.write_s = watch.seconds();
    if (a.output != "-") console.say("graph:         " + a.output);
  }
  return {};
}

Result<void> say_truth(const Job& job, const Console& console) {
  if (!job.truth) return {};
  const Graph& graph = job.document.graph;
  const auto before = compare_with_truth(graph, job.input_values, *job.truth);
  const auto after = compare_with_truth(graph, graph.values(), *job.truth);
  if (!before) return before.error();
  if (!after) return after.error();
  console.say(truth_line(*before, *after));
  return {};
}

int finish(const OptimizeArguments& a, const SolveOptions& options, Job& job,
           const Console& console) {
  const SolveSummary& summary = job.report.summary;
  const bool refused = a.strict && summary.status == SolveStatus::kPartiallyConstrained;
  const bool accepted = summary.usable() && !refused;
  Result<void> done = say_truth(job, console);
  if (done && accepted) done = write_results(a, options, job, console);
  if (!done) return fail(done.error());
  if (!a.json.empty()) {
    if (Result<void> written = write_file(a.json, json_text(job.report)); !written)
      return fail(written.error());
  }
  if (accepted) return kDone;
  Console::warn(why_not_usable(summary, refused));
  return kNotUsable;
}

}  // namespace

int run_optimize(const OptimizeArguments& a) {
  const Result<SolveOptions> options = solve_options(a);
  if (!options) return fail(options.error());
  if (Result<void> checked = check_arguments(a); !checked) return fail(checked.error());
  const bool stdout_is_output = a.output == "-" || a.json == "-" || a.covariances == "-";
  const Console console(stdout_is_output, a.quiet);

  Result<Job> job = read_job(a);
  if (!job) return fail(job.error());
  for (const std::string& line : warning_lines(job->document.warnings)) Console::warn(line);
  const InterruptGuard guard;  // from here on the first Ctrl-C stops the solver, not the program
  console.say(input_line(job->report));
  solve(*job, *options, a.gate, console);
  for (const std::string& line : solve_lines(job->report)) console.say(line);
  if (job->report.gate) console.say(gate_line(*job->report.gate));
  if (!job->report.summary.under_constrained.empty())
    Console::warn(under_constrained_line(job->report.summary));
  return finish(a, *options, *job, console);
}

}  // namespace cairn::cli
