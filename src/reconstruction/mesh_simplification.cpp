// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/mesh_cleanup.hpp"

namespace pcavr {

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t, double) { return mesh; }

}  // namespace pcavr
