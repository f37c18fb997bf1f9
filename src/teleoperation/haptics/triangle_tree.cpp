// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/triangle_tree.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"

namespace pcavr::detail {
namespace {

constexpr std::size_t kLeafSize = 4;
/// 2^32 triangles make 32 levels, and each level leaves one node on the stack.
constexpr std::size_t kMaxStackSize = 40;

double squared_distance(const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                        const Eigen::Vector3d& p) noexcept {
  return (low.cast<double>() - p).cwiseMax(p - high.cast<double>()).cwiseMax(0.0).squaredNorm();
}

/// Relative to a triangle's size: triangles overlap by this at their edges, so that rounding leaves
/// no gap.
constexpr double kOverlap = 1e-6;

/// The segment a b against a box (slab test): conservative, false positives only.
bool may_intersect(const Eigen::Vector3f& low, const Eigen::Vector3f& high,
                   const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  double from = 0.0;
  double to = 1.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double direction = b[i] - a[i];
    const double to_low = static_cast<double>(low[i]) - kOverlap - a[i];
    const double to_high = static_cast<double>(high[i]) + kOverlap - a[i];
    if (direction == 0.0) {
      if (to_low > 0.0 || to_high < 0.0) return false;
      continue;
    }
    from = std::max(from, std::min(to_low / direction, to_high / direction));
    to = std::min(to, std::max(to_low / direction, to_high / direction));
  }
  return from <= to;
}

/// Moeller-Trumbore intersection [1997], both sides.
bool intersects(const model::Triangle& t, const Eigen::Vector3d& a,
                const Eigen::Vector3d& b) noexcept {
  const Eigen::Vector3d direction = b - a;
  const Eigen::Vector3d side_b = t.b - t.a;
  const Eigen::Vector3d side_c = t.c - t.a;
  const Eigen::Vector3d across = direction.cross(side_c);
  const double volume = side_b.dot(across);
  if (volume == 0.0) return false;
  const Eigen::Vector3d to_a = a - t.a;
  const double u = to_a.dot(across) / volume;
  const Eigen::Vector3d around = to_a.cross(side_b);
  const double v = direction.dot(around) / volume;
  const double share = side_c.dot(around) / volume;
  return u >= -kOverlap && v >= -kOverlap && u + v <= 1.0 + kOverlap && share >= 0.0 &&
         share <= 1.0;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    PCAVR_REQUIRE(vertex.allFinite(), vertex.x(), vertex.y(), vertex.z());
  }
  std::vector<Corners> unordered;
  unordered.reserve(mesh.triangles.size());
  for (const auto& indices : mesh.triangles) {
    Corners& corners = unordered.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      PCAVR_REQUIRE(indices[i] < mesh.vertices.size(), indices[i], mesh.vertices.size());
      corners[i] = mesh.vertices[indices[i]];
    }
  }
  std::vector<std::uint32_t> order(unordered.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(unordered.size());
  nodes_.emplace_back();
  build(0, order, 0, unordered);
  triangles_.reserve(order.size());
  for (const std::uint32_t i : order) triangles_.push_back(unordered[i]);
}

void TriangleTree::build(std::uint32_t node, std::span<std::uint32_t> order, std::uint32_t first,
                         const std::vector<Corners>& unordered) {
  Eigen::AlignedBox3f box;
  Eigen::AlignedBox3f centroids;
  const auto centroid = [&](std::uint32_t i, Eigen::Index axis) {
    return unordered[i][0][axis] + unordered[i][1][axis] + unordered[i][2][axis];
  };
  for (const std::uint32_t i : order) {
    for (const Eigen::Vector3f& corner : unordered[i]) box.extend(corner);
    centroids.extend(Eigen::Vector3f(centroid(i, 0), centroid(i, 1), centroid(i, 2)));
  }
  nodes_[node] = {box.min(), box.max(), first, static_cast<std::uint32_t>(order.size())};
  if (order.size() <= kLeafSize) return;
  Eigen::Index axis = 0;
  centroids.sizes().maxCoeff(&axis);
  const std::size_t half = order.size() / 2;
  // Equal centroids by their index: one order on every machine.
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float at_a = centroid(a, axis);
                     const float at_b = centroid(b, axis);
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_[node].count = 0;
  nodes_.resize(nodes_.size() + 2);
  build(children, order.first(half), first, unordered);
  build(children + 1, order.subspan(half), first + static_cast<std::uint32_t>(half), unordered);
}

model::Triangle TriangleTree::triangle(std::uint32_t index) const noexcept {
  const Corners& corners = triangles_[index];
  return {corners[0].cast<double>(), corners[1].cast<double>(), corners[2].cast<double>()};
}

template <typename Enter, typename Visit>
void TriangleTree::traverse(const Enter& enter, const Visit& visit) const noexcept {
  if (triangles_.empty()) return;
  std::array<std::uint32_t, kMaxStackSize> stack;
  std::size_t stack_size = 0;
  stack[stack_size++] = 0;
  while (stack_size > 0) {
    const Node& node = nodes_[stack[--stack_size]];
    if (!enter(node.low, node.high)) continue;
    if (node.count == 0) {
      stack[stack_size++] = node.first + 1;
      stack[stack_size++] = node.first;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& c = triangles_[i];
      if (!enter(c[0].cwiseMin(c[1]).cwiseMin(c[2]), c[0].cwiseMax(c[1]).cwiseMax(c[2]))) continue;
      if (!visit(i)) return;
    }
  }
}

TriangleTree::Nearby TriangleTree::nearer_than(double reach, const Eigen::Vector3d& p,
                                               std::span<std::uint32_t> found) const noexcept {
  const double reach2 = reach * reach;
  Nearby nearby;
  traverse(
      [&](const auto& low, const auto& high) { return squared_distance(low, high, p) < reach2; },
      [&](std::uint32_t i) {
        if ((model::closest_point(triangle(i), p) - p).squaredNorm() >= reach2) return true;
        nearby.is_complete = nearby.count < found.size();
        if (nearby.is_complete) found[nearby.count++] = i;
        return nearby.is_complete;
      });
  return nearby;
}

bool TriangleTree::is_near(double reach, const Eigen::Vector3d& p) const noexcept {
  std::array<std::uint32_t, 1> found;
  const Nearby nearby = nearer_than(reach, p, found);
  return nearby.count > 0;
}

bool TriangleTree::is_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const noexcept {
  bool is_between = false;
  traverse([&](const auto& low, const auto& high) { return may_intersect(low, high, a, b); },
           [&](std::uint32_t i) {
             is_between = intersects(triangle(i), a, b);
             return !is_between;
           });
  return is_between;
}

}  // namespace pcavr::detail
