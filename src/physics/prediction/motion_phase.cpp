// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr {

std::string_view name_of(MotionPhase phase) noexcept {
  switch (phase) {
    case MotionPhase::free:
      return "free";
    case MotionPhase::static_contact:
      return "static";
    case MotionPhase::critical:
      return "critical";
    case MotionPhase::sliding:
      return "sliding";
  }
  return "free";
}

}  // namespace pcavr
