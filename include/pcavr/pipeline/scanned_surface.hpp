// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// Removes from a scan the triangles within 10 mm of a CAD body that stands in its place, so that
/// contact is with the body and not with its noisy scan. Both meshes in base [m].
void remove_surface_of(const TriangleMesh& body_base, TriangleMesh& scan_base);

}  // namespace pcavr
