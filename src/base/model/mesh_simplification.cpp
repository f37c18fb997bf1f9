// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/mesh_simplification.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "pcavr/base/core/check.hpp"

#include "base/model/fixed_simplification.hpp"
#include "base/model/quadric.hpp"

namespace pcavr {
namespace {

using model::Quadric;
using Triangle = std::array<std::uint32_t, 3>;

// Contrast of black and white counts as this geometric error [m], so that patterns on flat surfaces
// are preserved.
constexpr double kColorScale = 0.010;
// Weight of the plane through a border edge, perpendicular to its triangle, relative to the
// triangle.
constexpr double kBorderWeight = 10.0;
// Cosine of the maximum rotation of a triangle's normal in one collapse: 75 degrees.
constexpr double kMinRotationCosine = 0.26;
// Share of the edges, the cheapest, that are candidates in one round; none share a neighbour.
constexpr double kCandidateShare = 0.35;
// A round that removes a smaller share of the triangles has stalled.
constexpr double kMinRemovedShare = 0.005;

struct Collapse {
  double cost;
  std::uint32_t a;
  std::uint32_t b;
};

bool is_cheaper(const Collapse& left, const Collapse& right) {
  if (left.cost != right.cost) return left.cost < right.cost;
  return std::pair(left.a, left.b) < std::pair(right.a, right.b);
}

/// Rounds of edge collapses. In each round, the cheapest edges with disjoint neighbourhoods (an
/// independent set) are collapsed: close to the order of a priority queue at a fraction of its
/// cost.
class Simplifier {
 public:
  /// `is_fixed`: vertices that no collapse moves; empty: none.
  Simplifier(TriangleMesh mesh, double max_error, std::vector<bool> is_fixed = {})
      : mesh_(std::move(mesh)),
        max_error_(max_error),
        is_fixed_(std::move(is_fixed)),
        quadrics_(mesh_.vertices.size()) {
    find_triangles_around();
    add_triangle_planes();
    add_border_planes();
  }

  /// Leaves the vertices that no triangle uses any more.
  TriangleMesh run(std::size_t target) {
    while (mesh_.triangles.size() > target) {
      const std::size_t before = mesh_.triangles.size();
      collapse_round(before - target);
      std::erase_if(mesh_.triangles,
                    [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[0] == t[2]; });
      find_triangles_around();
      const auto removed = static_cast<double>(before - mesh_.triangles.size());
      if (removed < kMinRemovedShare * static_cast<double>(before) && is_stalled_) break;
      is_stalled_ = removed < kMinRemovedShare * static_cast<double>(before);
    }
    return std::move(mesh_);
  }

 private:
  void find_triangles_around() {
    first_.assign(mesh_.vertices.size() + 1, 0);
    for (const Triangle& t : mesh_.triangles) {
      for (const std::uint32_t v : t) ++first_[v + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    around_.resize(3 * mesh_.triangles.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      for (const std::uint32_t v : mesh_.triangles[i]) around_[next[v]++] = i;
    }
  }

  [[nodiscard]] std::span<const std::uint32_t> triangles_around(std::uint32_t v) const {
    return {around_.data() + first_[v], first_[v + 1] - first_[v]};
  }
  [[nodiscard]] Eigen::Vector3d point(std::uint32_t v) const {
    return mesh_.vertices[v].cast<double>();
  }
  [[nodiscard]] Eigen::Vector3d doubled_area(const Triangle& t) const {
    return (point(t[1]) - point(t[0])).cross(point(t[2]) - point(t[0]));
  }

  void add_triangle_planes() {
    for (const Triangle& t : mesh_.triangles) {
      const Eigen::Vector3d normal = doubled_area(t);
      const double length = normal.norm();
      if (!(length > 0.0)) continue;
      for (const std::uint32_t v : t) {
        quadrics_[v].add_plane(normal / length, point(t[0]), length / 6.0);
      }
    }
  }

  [[nodiscard]] int triangles_on(std::uint32_t a, std::uint32_t b) const {
    int count = 0;
    for (const std::uint32_t i : triangles_around(a)) {
      const Triangle& t = mesh_.triangles[i];
      count += t[0] == b || t[1] == b || t[2] == b ? 1 : 0;
    }
    return count;
  }

  void add_border_planes() {
    is_border_.assign(mesh_.vertices.size(), false);
    for (const Triangle& t : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i];
        const std::uint32_t b = t[(i + 1) % 3];
        if (triangles_on(a, b) == 2) continue;
        is_border_[a] = is_border_[b] = true;
        const Eigen::Vector3d normal = doubled_area(t).cross(point(b) - point(a));
        const double length = normal.norm();
        if (!(length > 0.0)) continue;
        const double weight = kBorderWeight * (point(b) - point(a)).squaredNorm();
        for (const std::uint32_t v : {a, b}) {
          // Errors are relative to the surface area: the border's weight is not part of it.
          const double area = quadrics_[v].area;
          quadrics_[v].add_plane(normal / length, point(a), weight);
          quadrics_[v].area = area;
        }
      }
    }
  }

  /// Position and cost of the vertex that replaces a and b.
  struct Placement {
    Eigen::Vector3d point;
    double error;  ///< of shape [m^4]
    double share;  ///< along the edge from a to b, for colours
  };

  [[nodiscard]] Placement place(std::uint32_t a, std::uint32_t b) const {
    Quadric sum = quadrics_[a];
    sum += quadrics_[b];
    const Eigen::Vector3d pa = point(a);
    const Eigen::Vector3d pb = point(b);
    // Relative to the midpoint, the numbers are small and the determinant is well conditioned.
    const Eigen::Vector3d middle = 0.5 * (pa + pb);
    const double length2 = (pb - pa).squaredNorm();
    Placement best{middle, sum.error(middle), 0.5};
    Eigen::Vector3d p = middle;
    if (sum.best_point(p) && (p - middle).squaredNorm() < length2) {
      const double share = length2 > 0.0 ? (p - pa).dot(pb - pa) / length2 : 0.5;
      return {p, sum.error(p), std::clamp(share, 0.0, 1.0)};
    }
    for (const auto& [end, share] : {std::pair(pa, 0.0), std::pair(pb, 1.0)}) {
      const double error = sum.error(end);
      if (error < best.error) best = {end, error, share};
    }
    return best;
  }

  [[nodiscard]] double color_cost(std::uint32_t a, std::uint32_t b) const {
    if (mesh_.colors.empty()) return 0.0;
    const Rgb8 ca = mesh_.colors[a];
    const Rgb8 cb = mesh_.colors[b];
    const double dr = ca.r - cb.r;
    const double dg = ca.g - cb.g;
    const double db = ca.b - cb.b;
    const double contrast2 = (dr * dr + dg * dg + db * db) / (3.0 * 255.0 * 255.0);
    const double area = std::min(quadrics_[a].area, quadrics_[b].area);
    return contrast2 * kColorScale * kColorScale * area;
  }

  [[nodiscard]] std::vector<Collapse> candidates() const {
    std::vector<Collapse> edges;
    edges.reserve(mesh_.triangles.size() * 3 / 2 + 1024);
    for (const Triangle& t : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i];
        const std::uint32_t b = t[(i + 1) % 3];
        if (!is_fixed_.empty() && (is_fixed_[a] || is_fixed_[b])) continue;
        // Each inner edge once; an edge between two borders would pinch the surface.
        const bool both_border = is_border_[a] && is_border_[b];
        if (!both_border && a > b) continue;
        if (both_border && triangles_on(a, b) != 1) continue;
        const Placement to = place(a, b);
        const double area = quadrics_[a].area + quadrics_[b].area;
        if (to.error > max_error_ * max_error_ * area) continue;
        // A small term of the length breaks ties on flat surfaces in favour of regular triangles.
        const double length2 = (point(a) - point(b)).squaredNorm();
        edges.push_back({to.error + color_cost(a, b) + 1e-6 * length2 * area, a, b});
      }
    }
    return edges;
  }

  void collapse_round(std::size_t max_removed) {
    std::vector<Collapse> edges = candidates();
    const auto count = std::min(
        edges.size(),
        static_cast<std::size_t>(kCandidateShare * static_cast<double>(edges.size())) + 64);
    const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(count);
    if (count < edges.size()) std::nth_element(edges.begin(), middle, edges.end(), is_cheaper);
    std::sort(edges.begin(), middle, is_cheaper);
    is_locked_.assign(mesh_.vertices.size(), false);
    std::size_t removed = 0;
    for (auto edge = edges.begin(); edge != middle && removed < max_removed; ++edge) {
      if (is_locked_[edge->a] || is_locked_[edge->b]) continue;
      removed += try_collapse(edge->a, edge->b);
    }
  }

  /// Link condition [Dey et al. 1999]: a and b have no common neighbours except those of the
  /// triangles between them; otherwise the collapse would make the surface non-manifold.
  [[nodiscard]] bool satisfies_link_condition(std::uint32_t a, std::uint32_t b, int between) {
    common_.clear();
    for (const std::uint32_t i : triangles_around(a)) {
      for (const std::uint32_t v : mesh_.triangles[i]) {
        if (v != a && v != b) common_.push_back(v);
      }
    }
    std::sort(common_.begin(), common_.end());
    common_.erase(std::unique(common_.begin(), common_.end()), common_.end());
    others_.clear();
    for (const std::uint32_t i : triangles_around(b)) {
      for (const std::uint32_t v : mesh_.triangles[i]) {
        if (v != a && v != b && std::binary_search(common_.begin(), common_.end(), v)) {
          others_.push_back(v);
        }
      }
    }
    std::sort(others_.begin(), others_.end());
    others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
    return static_cast<int>(others_.size()) == between;
  }

  /// Whether no triangle around `moved` flips or degenerates.
  [[nodiscard]] bool keeps_orientation(std::uint32_t moved, std::uint32_t other,
                                       const Eigen::Vector3d& to) const {
    for (const std::uint32_t i : triangles_around(moved)) {
      const Triangle& t = mesh_.triangles[i];
      if (t[0] == other || t[1] == other || t[2] == other) continue;
      std::array<Eigen::Vector3d, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = t[k] == moved ? to : point(t[k]);
      const Eigen::Vector3d before = doubled_area(t);
      const Eigen::Vector3d after = (p[1] - p[0]).cross(p[2] - p[0]);
      if (before.dot(after) < kMinRotationCosine * before.norm() * after.norm()) return false;
      if (!(after.norm() > 1e-3 * before.norm())) return false;
    }
    return true;
  }

  /// Number of triangles removed.
  std::size_t try_collapse(std::uint32_t a, std::uint32_t b) {
    const int between = triangles_on(a, b);
    if (between < 1 || between > 2 || !satisfies_link_condition(a, b, between)) return 0;
    const Placement to = place(a, b);
    if (!keeps_orientation(a, b, to.point) || !keeps_orientation(b, a, to.point)) return 0;
    lock_around(a);
    lock_around(b);
    interpolate_attributes(a, b, to.share);
    mesh_.vertices[a] = to.point.cast<float>();
    quadrics_[a] += quadrics_[b];
    is_border_[a] = is_border_[a] || is_border_[b];
    for (const std::uint32_t i : triangles_around(b)) {
      for (std::uint32_t& v : mesh_.triangles[i]) v = v == b ? a : v;
    }
    return static_cast<std::size_t>(between);
  }

  void lock_around(std::uint32_t v) {
    for (const std::uint32_t i : triangles_around(v)) {
      for (const std::uint32_t neighbour : mesh_.triangles[i]) is_locked_[neighbour] = true;
    }
  }

  void interpolate_attributes(std::uint32_t a, std::uint32_t b, double share) {
    if (!mesh_.colors.empty()) {
      const auto mix = [&](std::uint8_t from, std::uint8_t to) {
        return static_cast<std::uint8_t>(from + (to - from) * share + 0.5);
      };
      Rgb8& ca = mesh_.colors[a];
      const Rgb8 cb = mesh_.colors[b];
      ca = {mix(ca.r, cb.r), mix(ca.g, cb.g), mix(ca.b, cb.b)};
    }
    if (!mesh_.normals.empty()) {
      const auto s = static_cast<float>(share);
      const Eigen::Vector3f mixed = (1.0F - s) * mesh_.normals[a] + s * mesh_.normals[b];
      if (mixed.norm() > 0.0F) mesh_.normals[a] = mixed.normalized();
    }
  }

  TriangleMesh mesh_;
  double max_error_;
  std::vector<bool> is_fixed_;
  bool is_stalled_ = false;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> first_;  ///< by vertex: where its triangles begin in around_
  std::vector<std::uint32_t> around_;
  std::vector<bool> is_border_;
  std::vector<bool> is_locked_;
  std::vector<std::uint32_t> common_;
  std::vector<std::uint32_t> others_;
};

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t target_triangles, double max_error) {
  PCAVR_REQUIRE(max_error >= 0.0, max_error);
  if (mesh.triangles.size() <= target_triangles) return mesh;
  TriangleMesh simple = Simplifier(mesh, max_error).run(target_triangles);
  remove_unused_vertices(simple);
  return simple;
}

TriangleMesh simplified_between(TriangleMesh mesh, std::vector<bool> is_fixed,
                                std::size_t target_triangles, double max_error) {
  return Simplifier(std::move(mesh), max_error, std::move(is_fixed)).run(target_triangles);
}

}  // namespace pcavr
