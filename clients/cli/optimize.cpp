// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/optimize.hpp"

#include <memory>

#include "clients/cli/verb.hpp"

namespace cairn::cli {
namespace {

const Choices<Method> kMethods{
    {"lm", Method::kLevenbergMarquardt}, {"gn", Method::kGaussNewton}, {"dogleg", Method::kDogleg}};
const Choices<LinearBackend> kBackends{{"multifrontal", LinearBackend::kMultifrontal},
                                       {"cholmod", LinearBackend::kCholmod},
                                       {"ceres", LinearBackend::kCeres},
                                       {"eigen", LinearBackend::kEigen},
                                       {"pcg", LinearBackend::kPcg}};
const Choices<Kernel> kKernels{{"fastest", Kernel::kFastest},
                               {"portable", Kernel::kPortable},
                               {"avx2", Kernel::kAvx2},
                               {"avx512", Kernel::kAvx512}};
const Choices<InitMethod> kInits{{"auto", InitMethod::kAuto},
                                 {"file", InitMethod::kFile},
                                 {"odometry", InitMethod::kOdometry},
                                 {"tree", InitMethod::kTree},
                                 {"chordal", InitMethod::kChordal}};
const Choices<ErrorChart> kCharts{
    {"g2o", ErrorChart::kG2o}, {"log", ErrorChart::kLog}, {"gtsam", ErrorChart::kGtsam}};
const Choices<bool> kLossTargets{{"all", false}, {"loops", true}};

constexpr const char* kOptimizeFooter =
    "'-' stands for standard input or output; one output may be '-', the summary then goes to "
    "standard error.\n"
    "Formats are recognized by content; .gz and .bz2 are read as they are. Several inputs are "
    "merged by id.\n"
    "Ctrl-C stops after the running iteration and keeps the best estimate so far; like any other "
    "result it is\n"
    "written only when it may be used. A second Ctrl-C ends at once.\n"
    "Exit codes: 0 done, 2 usage, 3 bad input (nothing is written), 4 solved but not usable (only "
    "--json is\n"
    "written), 1 internal error.";

void add_input_options(CLI::App& verb, OptimizeArguments& a) {
  verb.add_option("IN", a.inputs, "graph files, or folders in the dlr layout")
      ->required()
      ->default_str("")
      ->type_name("FILE");
  verb.add_option("-o,--output", a.output, "write the optimized graph")->type_name("OUT");
  add_choice(verb, "--format", a.format, graph_formats(),
             "format of the input, where its content does not tell");
  add_choice(verb, "--to", a.to, graph_formats(),
             "format of the output; else by extension, else g2o");
}

void add_solver_options(CLI::App& verb, OptimizeArguments& a) {
  add_choice(verb, "--method", a.solve.method, kMethods, "minimizer");
  add_choice(verb, "--linear", a.solve.linear, kBackends,
             "solver of the linear systems (ceres: of everything)");
  add_choice(verb, "--init", a.solve.init, kInits, "start estimate; auto takes the cheapest");
  verb.add_option("--loss", a.loss, "robust loss: none, huber, cauchy, geman-mcclure, tukey, dcs")
      ->type_name("NAME[:WIDTH]");
  add_choice(verb, "--loss-on", a.solve.loss_on_loops_only, kLossTargets,
             "factors the loss is applied to");
  verb.add_flag("--gate", a.gate,
                "find loop closures that contradict the rest, and leave them out");
  verb.add_option("--threads", a.solve.threads,
                  "threads at most; 0: one per processor. Results do not depend on it")
      ->check(in_range(0, 1024))
      ->type_name("N");
  add_choice(verb, "--kernel", a.solve.kernel, kKernels,
             "instructions of the factorization; portable: the same bits on every processor");
  verb.add_option("--max-iterations", a.solve.max_iterations, "iteration limit")
      ->check(in_range(0, 1'000'000))
      ->type_name("N");
  add_choice(verb, "--error-chart", a.solve.chart, kCharts,
             "error of SE(3) rotations, for chi2 like other tools'");
}

void add_report_options(CLI::App& verb, OptimizeArguments& a) {
  verb.add_option("--json", a.json, "write a report for programs")->type_name("REPORT");
  verb.add_option("--plot", a.plots, "draw the graph before and after; may be repeated")
      ->default_str("")
      ->allow_extra_args(false)
      ->type_name("OUT.svg|OUT.png");
  verb.add_option("--covariances", a.covariances,
                  "write marginal covariances: id,dim,upper triangle (m, rad)")
      ->type_name("CSV");
  verb.add_option("--truth", a.truth, "true poses: report the trajectory error, draw them")
      ->type_name("FILE");
  verb.add_flag("--strict", a.strict, "warnings are errors: unknown tags 3, under-constrained 4");
  verb.add_flag("--quiet", a.quiet, "no summary, no progress; warnings and errors remain");
}

}  // namespace

Run add_optimize(CLI::App& parent, CLI::App*& verb) {
  auto arguments = std::make_shared<OptimizeArguments>();
  verb = parent.add_subcommand("optimize", "find the most probable poses and landmarks of a graph");
  add_input_options(*verb, *arguments);
  add_solver_options(*verb, *arguments);
  add_report_options(*verb, *arguments);
  verb->footer(kOptimizeFooter);
  return [arguments] { return run_optimize(*arguments); };
}

}  // namespace cairn::cli
