// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/option_sets.hpp"

namespace pcavr {

TeleopOptions replay_options(const TeleopOptions& teleop) {
  TeleopOptions options = teleop;
  options.inputs.segmentation = teleop.learning.segmentation;
  return options;
}

IdentificationOptions identification_options(const TeleopOptions& teleop, const PlanOptions& plan,
                                             const EstimatorOptions<3>& estimator) {
  return {.inputs = replay_options(teleop).inputs,
          .contact_fit = teleop.learning.contact_fit,
          .onset = teleop.learning.onset,
          .limiting_friction = teleop.learning.limiting_friction,
          .sliding = teleop.learning.sliding,
          .friction_priors = teleop.learning.friction_priors,
          .breakaway_priors = teleop.learning.breakaway_priors,
          .limit_surface = teleop.learning.limit_surface,
          .plan = plan,
          .estimator = estimator};
}

}  // namespace pcavr
