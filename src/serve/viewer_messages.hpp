// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"
#include "pcavr/serve/viewer_scene.hpp"

namespace pcavr {

/// The frame of the robot's camera.
inline constexpr char kCameraFrame[] = "camera";

/// The scan in base and the bodies, each in its frame of `frames`, in the order of `names`. They
/// refer to the scene's meshes.
[[nodiscard]] std::vector<cdr::MeshMarker> scene_markers(const ViewerScene& scene,
                                                         const std::vector<std::string>& names,
                                                         const std::vector<std::string>& frames);

[[nodiscard]] std::vector<cdr::Parameter> parameter_rows(const ParameterTable& parameters);

}  // namespace pcavr
