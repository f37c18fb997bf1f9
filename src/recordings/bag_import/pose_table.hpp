// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/bag_import/pose_list.hpp"

namespace pcavr {

/// A list of poses whose lengths have the unit of the file.
struct PosesInFileUnit {
  PoseList list;
  bool is_unit_stated = false;  ///< lengths are in metres
};

/// A row of the table is a pose.
[[nodiscard]] Expected<PosesInFileUnit> read_pose_table(const std::filesystem::path& file,
                                                        const PoseListOptions& options);

/// A file of the folder is a pose; `start`: what its name begins with.
[[nodiscard]] Expected<PosesInFileUnit> read_pose_folder(const std::filesystem::path& folder,
                                                         const std::string& start,
                                                         const PoseListOptions& options);

}  // namespace pcavr
