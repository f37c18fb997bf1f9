// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/camera.hpp"

#include "comparison_side.hpp"

namespace pcavr {

/// The recording behind a comparison: its camera, and its objects' meshes.
struct EvaluatedRecording {
  std::optional<CameraModel> camera;
  std::map<std::string, TriangleMesh> meshes_object;
};

/// Reads the reference's recording, else the subject's; missing meshes come from the scenes. Warns
/// where there is neither.
[[nodiscard]] Expected<EvaluatedRecording> read_evaluated_recording(const ComparisonSide& reference,
                                                                    const ComparisonSide& subject,
                                                                    const Observer& observer);

}  // namespace pcavr
