// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/mesh.hpp"

#include "painted_view.hpp"

namespace pcavr {

/// Evens out the views' exposures and white balances (exposure.hpp), and, if `with_poses`,
/// refines the registration of all and the pose of each view, so that the views agree on the
/// colours of the mesh [Zhou & Koltun 2014, sec. 4]: damped Gauss-Newton from coarse to fine
/// images. Returns the registration; it is the given one where another one does not agree better.
/// The mesh has normals.
[[nodiscard]] ColorRegistration align_colors(std::vector<PaintedView>& views,
                                             const TriangleMesh& mesh_base,
                                             const ColorRegistration& given, bool with_poses,
                                             Parallelism parallelism);

}  // namespace pcavr
