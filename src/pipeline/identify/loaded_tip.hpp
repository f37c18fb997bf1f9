// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// [m^2] Covariance of the tip at the tool's stamps, where the tool's poses are those that the
/// arm's encoders give: under load the tip lags by the deflection of the gears between encoder and
/// link, J K^-1 J^T f [Spong 1987]. At any two stamps these errors are proportional to the force:
/// they are one error and not independent ones. The deflection is not subtracted: a stiff contact's
/// law without it renders the encoders' noise several times larger.
///
/// Empty where the recording has no arm with joints, tool and wrench, or where the tool's poses are
/// a tracker's, which sees the tip itself. Errors: as of read_recorded_joints() and
/// parse_transmissions(). Thread-safe.
[[nodiscard]] Expected<std::vector<Eigen::Matrix3d>> tip_covariance(
    const Recording& recording, const LoadedTipOptions& options);

}  // namespace pcavr
