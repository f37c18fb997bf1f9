// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pcavr/recordings/bag_import/import_bag.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// The options of `import` for bags, as given.
struct BagArguments {
  BagTopicOptions topics;
  std::vector<std::string> objects;  ///< NAME=TOPIC
  std::string stamps = "header";
  bool invert_wrench = false;
  std::vector<double> tool_offset;  ///< [m] x y z; empty: not given
  double wrench_turn = 0.0;         ///< [deg]
  double tare = 0.0;                ///< [s] 0: nothing is taken off
  double tool_delay = 0.0;          ///< [s]
  bool find_world = false;
  std::vector<std::string> world_bags;     ///< by which it is found, beside the source
  std::vector<std::string> columns;        ///< of CSV files: NAME=COLUMN
  std::vector<std::string> units;          ///< of their columns: NAME=UNIT
  std::vector<std::string> object_places;  ///< NAME=POSE of the object in the tracked body
  std::string up;                          ///< the upward axis of a take: y or z; empty: not given
};

void add_bag_options(CLI::App& command, BagArguments& arguments);
/// The name of the first of these options that was given; empty where none was.
[[nodiscard]] std::string first_bag_option(const BagArguments& arguments);

/// How CSV files are read by these options. Fails where one is not NAME=VALUE.
[[nodiscard]] Expected<CsvOptions> csv_options(const BagArguments& arguments, bool skip_bad);

/// `options` has what bags share with other sources.
[[nodiscard]] Expected<CommandResult> run_import_bag(const std::string& source,
                                                     const OutputOption& output,
                                                     const BagArguments& arguments,
                                                     BagImportOptions options,
                                                     const Observer& observer);

/// Lists a bag's topics, and what `import` would take each for.
[[nodiscard]] Expected<CommandResult> inspect_bag(const std::filesystem::path& bag,
                                                  const Observer& observer);

}  // namespace pcavr::app
