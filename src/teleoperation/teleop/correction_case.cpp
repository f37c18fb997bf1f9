// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

std::string_view name_of(CorrectionCase which) noexcept {
  switch (which) {
    case CorrectionCase::both_static_force:
      return "1.1";
    case CorrectionCase::touched_by_operator:
      return "1.2a";
    case CorrectionCase::touched_by_robot:
      return "1.2b";
    case CorrectionCase::both_sliding:
      return "1.3";
    case CorrectionCase::phases_differ:
      return "2";
  }
  return "2";
}

}  // namespace pcavr
