// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/inertial_peak.hpp"

namespace pcavr {

bool is_inertial_peak(const Breakaway& peak, const IdentifiedParameter& sliding) {
  constexpr double kFastLoading = 0.1;      // [s] several periods of a hard contact's swing
  constexpr double kMinSlidingShare = 0.6;  // of the limit: dry friction has 0.6 to 1
  return sliding.is_excited && peak.force < kFastLoading * peak.loading_rate &&
         sliding.value < kMinSlidingShare * peak.force;
}

}  // namespace pcavr
