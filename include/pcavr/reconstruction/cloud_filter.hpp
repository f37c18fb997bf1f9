// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

struct OutlierOptions {
  int neighbours = 12;  ///< whose mean distance is judged; >= 1
  /// A point is dropped when that mean lies this many standard deviations above the cloud's. Small
  /// values eat the rims of sparse surfaces.
  double deviations = 4.0;
};

/// The cloud without the points that stand apart from their neighbours: statistical outlier
/// removal [Rusu et al. 2008, sec. 4.1], by PCL. Normals and colours stay with their points.
[[nodiscard]] PointCloud remove_outliers(const PointCloud& cloud,
                                         const OutlierOptions& options = {});

}  // namespace pcavr
