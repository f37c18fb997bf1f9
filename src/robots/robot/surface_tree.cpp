// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "surface_tree.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::robot {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
/// Largest number of pending parts: a part in a million triangles is split some 40 times at most.
constexpr std::size_t kMaxPending = 192;

/// A lower bound of the squared distance of a segment to a box: that of its own box, or that of its
/// middle less half its length.
double squared_bound(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                     const Eigen::AlignedBox3f& box) {
  const Eigen::Vector3d low = box.min().cast<double>();
  const Eigen::Vector3d high = box.max().cast<double>();
  const Eigen::Vector3d apart = (low - a.cwiseMax(b)).cwiseMax(a.cwiseMin(b) - high).cwiseMax(0.0);
  const Eigen::Vector3d middle = 0.5 * (a + b);
  const double from_middle = (low - middle).cwiseMax(middle - high).cwiseMax(0.0).norm();
  const double beyond = std::max(0.0, from_middle - 0.5 * (b - a).norm());
  return std::max(apart.squaredNorm(), beyond * beyond);
}

struct Part {
  std::uint32_t node;
  double from;  ///< fractions of the segment
  double to;
  double bound;  ///< [m^2]
};

}  // namespace

SurfaceTree::SurfaceTree(const TriangleMesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const std::array<std::uint32_t, 3>& corner : mesh.triangles) {
    triangles_.push_back(
        {mesh.vertices[corner[0]], mesh.vertices[corner[1]], mesh.vertices[corner[2]]});
  }
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void SurfaceTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  Eigen::AlignedBox3f box;
  Eigen::AlignedBox3f centres;
  const auto centre = [](const std::array<Eigen::Vector3f, 3>& t) -> Eigen::Vector3f {
    return (t[0] + t[1] + t[2]) / 3.0F;
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Eigen::Vector3f& corner : triangles_[i]) box.extend(corner);
    centres.extend(centre(triangles_[i]));
  }
  nodes_[node].box = box;
  if (count <= kLeafTriangles) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t half = count / 2;
  const auto begin = triangles_.begin() + first;
  std::nth_element(begin, begin + half, begin + count,
                   [&](const auto& a, const auto& b) { return centre(a)[axis] < centre(b)[axis]; });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(children, first, half);
  build(children + 1, first + half, count - half);
}

SegmentDistance SurfaceTree::distance_to(std::uint32_t triangle, const Eigen::Vector3d& a,
                                         const Eigen::Vector3d& b) const noexcept {
  const std::array<Eigen::Vector3f, 3>& t = triangles_[triangle];
  return segment_triangle_distance(a, b,
                                   {t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>()});
}

std::optional<std::uint32_t> SurfaceTree::find_nearer(const Eigen::Vector3d& a,
                                                      const Eigen::Vector3d& b,
                                                      SegmentDistance& best) const noexcept {
  std::optional<std::uint32_t> nearest;
  if (nodes_.empty()) return nearest;
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  std::array<Part, kMaxPending> pending;
  std::size_t count = 0;
  const auto push = [&](std::uint32_t node, double from, double to) {
    const double bound = squared_bound(a + from * along, a + to * along, nodes_[node].box);
    if (bound < best.squared && count < kMaxPending) pending[count++] = {node, from, to, bound};
  };
  /// The nearer one is visited first: it is pushed last.
  const auto push_both = [&](const Part& one, const Part& two) {
    push(one.node, one.from, one.to);
    push(two.node, two.from, two.to);
    if (count >= 2 && pending[count - 1].bound > pending[count - 2].bound) {
      std::swap(pending[count - 1], pending[count - 2]);
    }
  };
  push(0, 0.0, 1.0);
  while (count > 0) {
    const Part part = pending[--count];
    if (part.bound >= best.squared) continue;
    const Node& node = nodes_[part.node];
    const double size2 = static_cast<double>(node.box.sizes().squaredNorm());
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const SegmentDistance found = distance_to(i, a + part.from * along, a + part.to * along);
        if (!(found.squared < best.squared)) continue;
        best = found;
        nearest = i;
      }
    } else if (length2 * (part.to - part.from) * (part.to - part.from) > size2) {
      const double middle = 0.5 * (part.from + part.to);
      push_both({part.node, part.from, middle, 0.0}, {part.node, middle, part.to, 0.0});
    } else {
      push_both({node.first, part.from, part.to, 0.0}, {node.first + 1, part.from, part.to, 0.0});
    }
  }
  return nearest;
}

}  // namespace pcavr::robot
