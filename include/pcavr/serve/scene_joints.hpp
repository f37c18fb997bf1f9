// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The recorded joints in the order of the scene's arm; nothing where either is missing. Errors: a
/// log that can't be read, or is that of another arm.
[[nodiscard]] Expected<std::optional<JointLog>> read_scene_joints(const Recording& recording,
                                                                  const SceneManifest& scene);

}  // namespace pcavr
