// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pcavr/core/observer.hpp"
#include "pcavr/geometry/camera.hpp"

#include "comparison_side.hpp"

namespace pcavr {

/// What the recording behind a comparison tells: with which camera it was made, and how its objects
/// look.
struct EvaluatedRecording {
  std::optional<CameraModel> camera;
  std::map<std::string, TriangleMesh> meshes_object;
};

/// From the reference's recording, else the subject's; meshes that no recording has come from the
/// scenes. Warns where there is neither.
[[nodiscard]] Expected<EvaluatedRecording> read_evaluated_recording(const ComparisonSide& reference,
                                                                    const ComparisonSide& subject,
                                                                    const Observer& observer);

}  // namespace pcavr
