// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// How numbers state a pose.
enum class PoseForm {
  quaternion,       ///< position, then x y z w (or w x y z)
  rotation_vector,  ///< position, then the rotation vector [rad]
  matrix,           ///< the first three of four rows, or all, one after the other
};

/// "quaternions".
[[nodiscard]] const char* name_of(PoseForm form);

/// The form of `count` numbers that are a pose alone; nullopt where no form has as many.
[[nodiscard]] std::optional<PoseForm> form_of_count(std::size_t count);

/// The pose of the numbers, with its position in their unit. The Error has no file
/// and no line: a quaternion that is not of unit length, a matrix that is no rotation or mirrors, a
/// rotation vector that is in degrees.
[[nodiscard]] Expected<Pose> pose_of_numbers(PoseForm form, std::span<const double> numbers,
                                             bool is_w_first);

}  // namespace pcavr
