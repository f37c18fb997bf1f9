// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// An Error, without file and place, where the difference to another stamp may exceed 64 bits:
/// a recorder's clock does not show such a time.
[[nodiscard]] inline std::optional<Error> check_log_time(Stamp stamp) {
  std::optional<Error> error = check_range(ranges::kStamp, stamp.seconds());
  if (!error) return error;
  error->message = "log time: " + error->message;
  error->hint = "the file is damaged, or was not written by a recorder";
  return error;
}

}  // namespace pcavr
