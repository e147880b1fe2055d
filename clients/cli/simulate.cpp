// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "cairn/core/exit_code.hpp"
#include "cairn/io/graph_file.hpp"
#include "clients/cli/console.hpp"
#include "clients/cli/graph_format.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/verb.hpp"
#include "datasets/simulate.hpp"

namespace cairn::cli {
namespace {

struct SimulateArguments {
  SimulationOptions simulation;
  std::string output, truth;
  FormatChoice to;
  bool quiet = false;
};

Choices<World> worlds() {
  Choices<World> choices;
  for (const std::string& name : world_names()) choices.emplace_back(name, *find_world(name));
  return choices;
}

Choices<Sensor> sensors() {
  Choices<Sensor> choices;
  for (const std::string& name : sensor_names()) choices.emplace_back(name, *find_sensor(name));
  return choices;
}

std::string summary(const SimulateArguments& a, const GraphDocument& document,
                    std::size_t outliers) {
  std::string line(to_string(a.simulation.world));
  line += ": " + std::to_string(document.graph.variables().size()) + " variables, " +
          std::to_string(document.graph.factor_count()) + " factors";
  if (outliers > 0) line += ", " + std::to_string(outliers) + " of them false";
  return line + ", seed " + std::to_string(a.simulation.seed) + " -> " + a.output;
}

int run_simulate(const SimulateArguments& a) {
  if (Result<void> outputs = check_outputs({a.output, a.truth}); !outputs)
    return fail(outputs.error());
  Result<SimulatedGraph> world = simulate(a.simulation);
  if (!world) return fail(world.error());

  GraphDocument document;
  document.graph = std::move(world->graph);
  document.has_start.assign(document.graph.variables().size(), true);
  document.offsets2 = std::move(world->offsets2);
  document.offsets3 = std::move(world->offsets3);
  Result<void> written = write_graph(document, a.output, output_format(a.to, a.output));
  if (written && !a.truth.empty()) {
    document.graph.values() = std::move(world->truth);
    written = write_graph(document, a.truth, output_format(a.to, a.truth));
  }
  if (!written) return fail(written.error());
  const bool output_on_stdout = a.output == "-" || a.truth == "-";
  Console(output_on_stdout, a.quiet).say(summary(a, document, world->outliers.size()));
  return kDone;
}

}  // namespace

Run add_simulate(CLI::App& parent, CLI::App*& verb) {
  auto a = std::make_shared<SimulateArguments>();
  verb = parent.add_subcommand("simulate", "make a graph whose truth is known");
  SimulationOptions& s = a->simulation;
  add_choice(*verb, "WORLD", s.world, worlds(), "where the robot drives")->required();
  verb->add_option("--poses", s.poses, "number of poses; 0: as many as is usual for the world")
      ->type_name("N");
  verb->add_option("--seed", s.seed, "the same seed gives the same graph on every machine")
      ->type_name("N");
  verb->add_option("--noise", s.noise, "scales every standard deviation, 0 (exact) to 10")
      ->type_name("F");
  verb->add_option("--outliers", s.outliers, "fraction of the loop closures that are false, 0 to 1")
      ->type_name("F");
  add_choice(*verb, "--sensor", s.sensor, sensors(),
             "what the landmarks world measures beside odometry");
  verb->add_option("-o,--output", a->output, "the graph; '-' is standard output")
      ->required()
      ->type_name("OUT");
  verb->add_option("--truth", a->truth, "also the same graph with true values")->type_name("FILE");
  add_choice(*verb, "--to", a->to, graph_formats(),
             "format to write; by default the extension decides");
  verb->add_flag("--quiet", a->quiet, "print nothing");
  verb->footer(
      "The noise of every measurement is drawn from its information, so the optimum has a chi2 of "
      "about "
      "the degrees of freedom. Worlds and sensors: datasets/README.md.");
  return [a] { return run_simulate(*a); };
}

}  // namespace cairn::cli
