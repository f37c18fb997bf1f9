// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {

/// A body whose motion is known, on the tool's clock. Refers to both.
struct BodyMotion {
  const CadModel& model;
  std::span<const TrackedPose> tracked;
};

}  // namespace pcavr
