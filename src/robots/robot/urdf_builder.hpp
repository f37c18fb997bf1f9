// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <urdf_model/model.h>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "robots/robot/urdf_structure.hpp"

namespace pcavr::robot {

/// The model of a parsed description whose tree was checked. `file` must outlive the call.
[[nodiscard]] Expected<RobotModel> build_robot(const urdf::ModelInterface& description,
                                               const UrdfStructure& structure,
                                               const std::filesystem::path& file,
                                               const UrdfOptions& options);

struct InertiaFindings {
  std::vector<Error> faults;  ///< what requires_inertia makes an Error
  std::vector<Error> doubts;  ///< possible, but probably not the real values
};
[[nodiscard]] InertiaFindings check_inertias(const RobotModel& model,
                                             const UrdfStructure& structure);

}  // namespace pcavr::robot
