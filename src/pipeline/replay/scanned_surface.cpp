// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/scanned_surface.hpp"

#include <algorithm>
#include <vector>

#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

/// [m] Two voxels of a coarse scan, and more than a depth camera's noise at 2 m.
constexpr float kMaxScanDistance = 0.01F;

}  // namespace

void remove_surface_of(const TriangleMesh& body_base, TriangleMesh& scan_base) {
  const SurfaceQuery body(body_base);
  std::vector<bool> is_near;
  is_near.reserve(scan_base.vertices.size());
  for (const Eigen::Vector3f& vertex : scan_base.vertices) {
    is_near.push_back(body.closest(vertex, kMaxScanDistance).has_value());
  }
  std::erase_if(scan_base.triangles, [&](const auto& corners) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](std::uint32_t corner) { return is_near[corner]; });
  });
}

}  // namespace pcavr
