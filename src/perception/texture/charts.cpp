// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A projection stretches a surface by at most 1.6 within 50 degrees.
const float kMinGrowthCosine = std::cos(50.0F * static_cast<float>(M_PI) / 180.0F);
/// Small charts are joined with a neighbour within 75 degrees: stretched by up to 4, but small.
const float kMinJoinCosine = std::cos(75.0F * static_cast<float>(M_PI) / 180.0F);
constexpr std::size_t kMinTriangles = 12;  ///< of a chart that is not small
constexpr std::size_t kTrianglesPerChunk = 4096;

Eigen::Vector3f doubled_area(const TriangleMesh& mesh, const Triangle& t) {
  return (mesh.vertices[t[1]] - mesh.vertices[t[0]])
      .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
}

/// The triangle on the other side of each edge, by triangle and edge; kNone at borders and where
/// more than two meet.
std::vector<Triangle> neighbours_of(const TriangleMesh& mesh) {
  struct Edge {
    std::uint32_t a;
    std::uint32_t b;
    std::uint32_t triangle;
    std::uint32_t side;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t side = 0; side < 3; ++side) {
      const std::uint32_t a = mesh.triangles[i][side];
      const std::uint32_t b = mesh.triangles[i][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), i, side});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tuple(l.a, l.b, l.triangle) < std::tuple(r.a, r.b, r.triangle);
  });
  std::vector<Triangle> neighbours(mesh.triangles.size(), Triangle{kNone, kNone, kNone});
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].a == edges[begin].a && edges[end].b == edges[begin].b)
      ++end;
    if (end - begin == 2) {
      const Edge& one = edges[begin];
      const Edge& other = edges[begin + 1];
      neighbours[one.triangle][one.side] = other.triangle;
      neighbours[other.triangle][other.side] = one.triangle;
    }
    begin = end;
  }
  return neighbours;
}

/// Divides a mesh into charts: which chart each triangle belongs to.
class ChartGrowth {
 public:
  explicit ChartGrowth(const TriangleMesh& mesh)
      : neighbours_(neighbours_of(mesh)), chart_of_(mesh.triangles.size(), kNone) {
    for (const Triangle& triangle : mesh.triangles) areas_.push_back(doubled_area(mesh, triangle));
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> seeds(areas_.size());
    std::iota(seeds.begin(), seeds.end(), 0U);
    std::stable_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
      return areas_[a].squaredNorm() > areas_[b].squaredNorm();
    });
    for (const std::uint32_t seed : seeds) {
      if (chart_of_[seed] == kNone) grow(seed);
    }
    for (int round = 0; round < 3; ++round) join_small();
    return renumbered();
  }

 private:
  /// Breadth first, so that a chart is round, within a cone around its mean normal.
  void grow(std::uint32_t seed) {
    const auto chart = static_cast<std::uint32_t>(sums_.size());
    Eigen::Vector3f sum = areas_[seed];
    std::vector<std::uint32_t> open = {seed};
    chart_of_[seed] = chart;
    for (std::size_t next = 0; next < open.size(); ++next) {
      for (const std::uint32_t other : neighbours_[open[next]]) {
        if (other == kNone || chart_of_[other] != kNone) continue;
        if (areas_[other].dot(sum) < kMinGrowthCosine * areas_[other].norm() * sum.norm()) continue;
        chart_of_[other] = chart;
        sum += areas_[other];
        open.push_back(other);
      }
    }
    sums_.push_back(sum);
    members_.push_back(std::move(open));
  }

  /// The chart around a small one whose direction is nearest; kNone where none is near enough.
  [[nodiscard]] std::uint32_t neighbour_chart(std::uint32_t chart) const {
    std::uint32_t best = kNone;
    float best_cosine = kMinJoinCosine;
    for (const std::uint32_t member : members_[chart]) {
      for (const std::uint32_t other : neighbours_[member]) {
        if (other == kNone || chart_of_[other] == chart) continue;
        const Eigen::Vector3f& sum = sums_[chart_of_[other]];
        const float cosine = sum.normalized().dot(sums_[chart].normalized());
        if (!(cosine > best_cosine)) continue;
        best_cosine = cosine;
        best = chart_of_[other];
      }
    }
    return best;
  }

  void join_small() {
    for (std::uint32_t chart = 0; chart < members_.size(); ++chart) {
      if (members_[chart].empty() || members_[chart].size() >= kMinTriangles) continue;
      const std::uint32_t target = neighbour_chart(chart);
      if (target == kNone) continue;
      for (const std::uint32_t member : members_[chart]) chart_of_[member] = target;
      sums_[target] += sums_[chart];
      members_[target].insert(members_[target].end(), members_[chart].begin(),
                              members_[chart].end());
      members_[chart].clear();
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> renumbered() const {
    std::vector<std::uint32_t> number(members_.size(), kNone);
    std::uint32_t count = 0;
    for (std::size_t chart = 0; chart < members_.size(); ++chart) {
      if (!members_[chart].empty()) number[chart] = count++;
    }
    std::vector<std::uint32_t> result;
    for (const std::uint32_t chart : chart_of_) result.push_back(number[chart]);
    return result;
  }

  std::vector<Triangle> neighbours_;
  std::vector<std::uint32_t> chart_of_;  ///< by triangle
  std::vector<Eigen::Vector3f> areas_;   ///< by triangle: the normal times twice the area [m^2]
  std::vector<Eigen::Vector3f> sums_;    ///< by chart: of its members' areas_
  std::vector<std::vector<std::uint32_t>> members_;
};

/// Root mean square edge of the triangles, as if they were right-angled.
float typical_edge(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& triangle : mesh.triangles)
    sum += static_cast<double>(doubled_area(mesh, triangle).norm());
  return static_cast<float>(
      std::sqrt(sum / std::max(1.0, static_cast<double>(mesh.triangles.size()))));
}

/// The chart of each triangle of a finer level: that of the nearest coarse triangle, searched from
/// in front of the surface, so that of a thin sheet's two sides its own is nearer. Searched for
/// the vertices, which are half as many as the triangles; for a triangle where they disagree.
std::vector<std::uint32_t> charts_of_level(const TriangleMesh& level, const SurfaceQuery& coarse,
                                           const std::vector<std::uint32_t>& chart_of_coarse,
                                           Parallelism parallelism) {
  const auto chart_at = [&](const Eigen::Vector3f& point) {
    for (float radius = 0.005F; radius < 10.0F; radius *= 4.0F) {
      const auto closest = coarse.closest(point, radius);
      if (closest) return chart_of_coarse[closest->triangle];
    }
    return 0U;
  };
  const float to_front = 0.5F * typical_edge(level);
  std::vector<std::uint32_t> of_vertex(level.vertices.size());
  parallel_for(parallelism, of_vertex.size(), kTrianglesPerChunk,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i)
                   of_vertex[i] = chart_at(level.vertices[i] + to_front * level.normals[i]);
               });
  std::vector<std::uint32_t> charts(level.triangles.size());
  parallel_for(parallelism, charts.size(), kTrianglesPerChunk,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const auto& [a, b, c] = level.triangles[i];
                   charts[i] = of_vertex[a];
                   if (of_vertex[b] == charts[i] && of_vertex[c] == charts[i]) continue;
                   const Eigen::Vector3f center =
                       (level.vertices[a] + level.vertices[b] + level.vertices[c]) / 3.0F;
                   const Eigen::Vector3f area = doubled_area(level, level.triangles[i]);
                   charts[i] = chart_at(center + to_front * area.normalized());
                 }
               });
  return charts;
}

/// The axes in the chart's plane, turned so that the chart's box is small.
Eigen::Matrix<float, 2, 3> tight_axes(const Eigen::Vector3f& normal,
                                      const std::vector<Eigen::Vector3f>& points) {
  const Eigen::Vector3f x = normal.unitOrthogonal();
  const Eigen::Vector3f y = normal.cross(x);
  Eigen::Matrix<float, 2, 3> best;
  float best_area = std::numeric_limits<float>::infinity();
  constexpr int kTurns = 18;  // of 5 degrees
  for (int turn = 0; turn < kTurns; ++turn) {
    const float angle = static_cast<float>(turn) * static_cast<float>(M_PI_2) / kTurns;
    Eigen::Matrix<float, 2, 3> axes;
    axes.row(0) = (std::cos(angle) * x + std::sin(angle) * y).transpose();
    axes.row(1) = (std::cos(angle) * y - std::sin(angle) * x).transpose();
    Eigen::AlignedBox2f box;
    for (const Eigen::Vector3f& point : points) box.extend(axes * point);
    if (box.volume() >= best_area) continue;
    best_area = box.volume();
    best = axes;
  }
  // Wider than high: the packing sorts by height.
  Eigen::AlignedBox2f box;
  for (const Eigen::Vector3f& point : points) box.extend(best * point);
  if (box.sizes().x() < box.sizes().y()) {
    const Eigen::RowVector3f old = best.row(0);
    best.row(0) = best.row(1);
    best.row(1) = -old;
  }
  return best;
}

}  // namespace

ChartSet make_charts(const std::vector<TriangleMesh>& levels_base, Parallelism parallelism) {
  ChartSet set;
  const TriangleMesh& coarse = levels_base.back();
  const std::vector<std::uint32_t> chart_of_coarse = ChartGrowth(coarse).run();
  const SurfaceQuery query(coarse);
  for (std::size_t level = 0; level + 1 < levels_base.size(); ++level) {
    set.chart_of_triangle.push_back(
        charts_of_level(levels_base[level], query, chart_of_coarse, parallelism));
  }
  set.chart_of_triangle.push_back(chart_of_coarse);
  const std::uint32_t count = *std::max_element(chart_of_coarse.begin(), chart_of_coarse.end()) + 1;
  std::vector<Eigen::Vector3f> normals(count, Eigen::Vector3f::Zero());
  std::vector<std::vector<Eigen::Vector3f>> points(count);
  for (std::size_t i = 0; i < coarse.triangles.size(); ++i) {
    normals[chart_of_coarse[i]] += doubled_area(coarse, coarse.triangles[i]);
    for (const std::uint32_t v : coarse.triangles[i])
      points[chart_of_coarse[i]].push_back(coarse.vertices[v]);
  }
  set.charts.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Chart& chart = set.charts[i];
    if (normals[i].norm() > 0.0F) chart.normal_base = normals[i].normalized();
    chart.axes_base = tight_axes(chart.normal_base, points[i]);
  }
  for (std::size_t level = 0; level < levels_base.size(); ++level) {
    const TriangleMesh& mesh = levels_base[level];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      Chart& chart = set.charts[set.chart_of_triangle[level][i]];
      for (const std::uint32_t v : mesh.triangles[i])
        chart.box.extend(chart.on_axes(mesh.vertices[v]));
    }
  }
  return set;
}

}  // namespace pcavr
