// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/marker/tag_layout.hpp"

namespace pcavr {

/// Which stated poses define the body's frame, and where that is.
struct LayoutFrame {
  Pose T_body_layout = {};
  std::vector<std::size_t> references = {};  ///< indices of the tags; empty: none has a stated pose
};

/// Least squares of the corners of the fixed tags; without any, of the largest set of tags whose
/// stated poses agree with `T_layout_tag`. An Error where two sets are as large as each other.
[[nodiscard]] Expected<LayoutFrame> find_layout_frame(const std::vector<LayoutTag>& tags,
                                                      const std::vector<Pose>& T_layout_tag);

/// The covariances of the tags' twists against the frame that the references define; `covariance`
/// is against the datum, with 6 rows a tag.
[[nodiscard]] Eigen::MatrixXd covariance_in_frame(const std::vector<LayoutTag>& tags,
                                                  const std::vector<Pose>& T_layout_tag,
                                                  const std::vector<std::size_t>& references,
                                                  const Eigen::MatrixXd& covariance);

/// Where the tag is against where it is said to be.
[[nodiscard]] TagShift shift_of(const Pose& T_body_tag, const Pose& T_body_tag_stated);

}  // namespace pcavr
