// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/single_glb.hpp"

#include "pcavr/base/geometry/sharp_edges.hpp"

#include "perception/scene/glb_writer.hpp"

namespace pcavr {

std::string format_single_glb(const std::string& name, const TriangleMesh& mesh_base,
                              bool is_scanned) {
  GlbWriter glb;
  const int root = glb.add_node("base", glb_root_pose(), -1);
  const int mesh = is_scanned ? glb.add_mesh(name, mesh_base, GlbMaterial::captured)
                              : glb.add_mesh(name, with_sharp_edges(mesh_base), GlbMaterial::body);
  return glb.finish(root, {glb.add_node(name, Pose(), mesh)});
}

}  // namespace pcavr
