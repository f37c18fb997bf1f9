// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/perception/reconstruction/options.cpp for meanings, ranges and defaults.
struct OutlierOptions {
  OutlierOptions();

  int neighbours;
  double std_multiplier;
};

/// The options "reconstruction.outliers".
[[nodiscard]] OptionSection section_of(OutlierOptions& options);

/// Statistical outlier removal [Rusu et al. 2008, sec. 4.1], by PCL. Normals and colours stay with
/// their points.
[[nodiscard]] PointCloud remove_outliers(const PointCloud& cloud,
                                         const OutlierOptions& options = {});

}  // namespace pcavr
