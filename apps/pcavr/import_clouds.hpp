// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "pcavr/pipeline/import_clouds.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// The options of `import` that are for point clouds.
struct CloudArguments {
  std::string poses;
  std::string manifest;
  std::vector<double> T_base_world;  ///< tx ty tz qx qy qz qw
  bool anchor_tags = false;
  std::string unit;
  bool unorganised = false;
  int threads = 0;
};

void add_cloud_options(CLI::App& command, CloudArguments& arguments);

/// The first of these options that was given; empty for none.
[[nodiscard]] std::string first_cloud_option(const CloudArguments& arguments);

/// The pose that --T-base-world gives as numbers.
[[nodiscard]] Expected<Pose> parse_pose(const std::vector<double>& numbers,
                                        const std::string& option);

struct CloudPaths {
  std::string source;
  OutputOption output;
};

/// Imports point clouds and commits the recording; `options` has what other sources share.
[[nodiscard]] Expected<CommandResult> run_import_clouds(const CloudPaths& paths,
                                                        const CloudArguments& arguments,
                                                        CloudImportOptions options,
                                                        const Observer& observer);

}  // namespace pcavr::app
