// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "configuration.hpp"

#include "pcavr/base/core/options.hpp"
#include "pcavr/pipeline/option_sets.hpp"
#include "pcavr/recordings/recording/option_file.hpp"

namespace pcavr::app {
namespace {

void append(std::vector<OptionSection>& sections, std::vector<OptionSection> more) {
  for (OptionSection& section : more) sections.push_back(std::move(section));
}

}  // namespace

std::vector<OptionSection> Configuration::sections() {
  std::vector<OptionSection> sections{section_of(reading)};
  append(sections, sections_of(perception()));
  append(sections, sections_of(build));
  append(sections, sections_of(teleop));
  append(sections,
         {section_of(serve), section_of(serve.force), section_of(serve.haptics), section_of(live),
          section_of(live.vibration), section_of(live.tool), section_of(content),
          section_of(network), section_of(page), section_of(devices.rate),
          section_of(devices.gamepad), section_of(devices.space_mouse), section_of(devices.trace),
          section_of(devices.plugin), section_of(devices.simulated)});
  append(sections, sections_of(evaluation));
  sections.push_back(section_of(plan));
  sections.push_back(section_of(estimator));
  sections.push_back(section_of(estimator.averaging));
  sections.push_back(section_of(robot_identification.signals));
  sections.push_back(section_of(robot_identification.fit));
  sections.push_back(section_of(robot_identification.contact));
  sections.push_back(section_of(robot_identification.trial));
  sections.push_back(section_of(robot_identification.intervals));
  sections.push_back(section_of(robot_identification.plan));
  sections.push_back(section_of(robot_identification.payload));
  sections.push_back(section_of(arm));
  sections.push_back(section_of(arm.inverse_kinematics));
  sections.push_back(section_of(arm_drive));
  sections.push_back(section_of(arm_query));
  sections.push_back(section_of(robot_site));
  sections.push_back(section_of(robot_site.commands));
  sections.push_back(section_of(robot_site.limits));
  sections.push_back(section_of(robot_site.pictures));
  sections.push_back(section_of(operator_site));
  sections.push_back(section_of(black_box));
  sections.push_back(section_of(recorder));
  return sections;
}

TeleopOptions Configuration::replayed() const { return replay_options(teleop); }

IdentificationOptions Configuration::identification() const {
  return identification_options(teleop, plan, estimator);
}

std::vector<std::pair<std::string, std::string>> Configuration::changed() {
  return changed_options(sections());
}

void add_configuration_options(CLI::App& app, Configuration& configuration,
                               ConfigurationOptions& options) {
  app.add_option_function<std::string>(
         "--config",
         [&configuration, &options](const std::string& file) {
           const Expected<void> read = read_options(file, configuration.sections());
           if (!read) options.error = read.error();
         },
         "YAML file with options, for any command; --print-config lists them")
      ->trigger_on_parse();
  app.add_flag("--print-config", options.is_printed,
               "Print the options of a configuration file that the command uses, with their "
               "values in force, and exit");
}

}  // namespace pcavr::app
