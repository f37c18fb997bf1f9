// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

struct OutlierOptions {
  int neighbours = 12;  ///< for the mean distance to the k nearest neighbours; >= 1
  /// A point is an outlier where its mean distance is more than this many standard deviations above
  /// the cloud's mean. Small values erode the boundaries of sparse surfaces.
  double std_multiplier = 4.0;
};

/// Statistical outlier removal [Rusu et al. 2008, sec. 4.1], by PCL. Normals and colours stay with
/// their points.
[[nodiscard]] PointCloud remove_outliers(const PointCloud& cloud,
                                         const OutlierOptions& options = {});

}  // namespace pcavr
