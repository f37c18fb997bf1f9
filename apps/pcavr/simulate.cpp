// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>

#include "pcavr/core/output.hpp"

#include "commands.hpp"

namespace pcavr::app {
namespace {

struct SimulateArguments {
  std::string name;
  OutputOption output;
  std::uint64_t seed = 1;
  int threads = 1;
};

Expected<CommandResult> run_simulation(const SimulateArguments& arguments,
                                       const Observer& observer) {
  const std::vector<SimulationCase>& cases = simulation_cases();
  const auto chosen = std::find_if(cases.begin(), cases.end(), [&](const SimulationCase& known) {
    return known.name == arguments.name;
  });
  Expected<OutputFolder> folder =
      OutputFolder::create(arguments.output.folder, arguments.output.replace);
  if (!folder) return folder.error();
  const Expected<void> done =
      simulate(*chosen, arguments.seed, folder->path(), {arguments.threads}, observer);
  if (!done) return done.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return CommandResult{.summary = "next: pcavr build " + arguments.output.folder + " -o SCENE\n",
                       .json = {{"recording", arguments.output.folder},
                                {"case", arguments.name},
                                {"seed", arguments.seed}}};
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("simulate", "Make a recording with exact truth by ray casting");
  std::string footer = "Cases:\n";
  std::vector<std::string> names;
  for (const SimulationCase& known : simulation_cases()) {
    names.push_back(known.name);
    footer += "  " + known.name + ": " + known.description + '\n';
  }
  command->footer(footer + "\nExample:\n  pcavr simulate " + names.front() +
                  " -o my_recording --seed 7");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("case", arguments->name, "What to simulate")
      ->required()
      ->check(CLI::IsMember(names));
  add_output_option(*command, arguments->output, "Folder for the recording");
  command->add_option("--seed", arguments->seed, "The same seed gives the same bytes")
      ->capture_default_str();
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_simulation(*arguments, observer); };
  });
}

}  // namespace pcavr::app
