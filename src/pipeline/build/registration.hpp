// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/build_limits.hpp"

#include "survey.hpp"

namespace pcavr {

/// The bodies of a recording, and the poses of its frames in base.
struct Registration {
  std::vector<DeclaredBody> bodies;  ///< movable
  std::vector<DeclaredBody> immovable;
  Survey survey;
};

/// The first step of a build: loads the bodies, finds tags and the camera's poses unless they are
/// known, and estimates the memory that the rest takes, before the long work where poses are
/// stated.
[[nodiscard]] Expected<Registration> register_frames(const BuildLimits& limits,
                                                     const Recording& recording,
                                                     const BuildOptions& options,
                                                     const Observer& observer,
                                                     std::optional<Survey> known_survey = {});

[[nodiscard]] SurveyOptions survey_options(const BuildOptions& options);

}  // namespace pcavr
