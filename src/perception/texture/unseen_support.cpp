// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/unseen_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/base/model/cad_model.hpp"

#include "fill_gaps.hpp"
#include "synthesise_grain.hpp"

namespace pcavr {
namespace {

/// Depth beyond the plane by more than noise and the plane's error is another surface [m].
constexpr double kBehind = 0.03;
/// The squares lie that much below the plane, so that the scan is drawn above them [m].
constexpr double kBelow = 0.001;
/// Squares by which what something dynamic hid is continued to the scan beside it: depth at edges
/// is not fused, so that the scan may end before the mask begins.
constexpr int kGap = 3;
/// Smallest cosine between a triangle's normal and the plane's: steeper triangles are the foot of
/// something on the plane.
constexpr float kMinCosine = 0.9F;
/// Squares beside what is not the plane whose colours are not continued: fused ones are mixed.
constexpr int kMixed = 5;
/// Squares per side of an area; larger areas get larger squares.
constexpr int kMaxSide = 1000;

/// A view's camera on the depth grid.
struct DepthView {
  const TextureView* view;
  CameraModel camera;
  Pose T_camera_base;
};

bool is_inside(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector3d& p) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d side = (outline[(i + 1) % outline.size()] - outline[i]).head<2>();
    const Eigen::Vector2d to = (p - outline[i]).head<2>();
    if (side.x() * to.y() - side.y() * to.x() < 0.0) return false;
  }
  return true;
}

/// The evidence of a view; of several views, the last in this order counts.
enum class Evidence { none, hidden_by_dynamic, seen_through };

Evidence evidence_of(const DepthView& from, const Eigen::Vector3d& p_base) {
  const Eigen::Vector3d p = from.T_camera_base * p_base;
  if (!(p.z() > 0.05)) return Evidence::none;
  const Eigen::Vector2d pixel = from.camera.project(p);
  const std::optional<int> x = pixel_index(pixel.x(), from.camera.width);
  const std::optional<int> y = pixel_index(pixel.y(), from.camera.height);
  if (!x || !y) return Evidence::none;
  const MaskImage& mask = from.view->is_dynamic;
  if (!mask.empty() && mask(*x, *y) != 0) return Evidence::hidden_by_dynamic;
  const double measured = static_cast<double>(from.view->depth(*x, *y));
  return measured > p.z() + kBehind ? Evidence::seen_through : Evidence::none;
}

/// The mask and its neighbours in `other`.
MaskImage grown_into(const MaskImage& mask, const MaskImage& other) {
  MaskImage grown = mask;
  const auto is_set = [&](int x, int y) { return mask.contains(x, y) && mask(x, y) != 0; };
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (other(x, y) == 0) continue;
      const bool is_beside =
          is_set(x - 1, y) || is_set(x + 1, y) || is_set(x, y - 1) || is_set(x, y + 1);
      if (is_beside) grown(x, y) = 1;
    }
  }
  return grown;
}

/// The mask without the pixels that touch others, or the image's border.
MaskImage shrunk(const MaskImage& mask) {
  MaskImage result = mask;
  const auto is_set = [&](int x, int y) { return mask.contains(x, y) && mask(x, y) != 0; };
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const bool is_inner =
          is_set(x - 1, y) && is_set(x + 1, y) && is_set(x, y - 1) && is_set(x, y + 1);
      if (!is_inner) result(x, y) = 0;
    }
  }
  return result;
}

/// The pixels whose colours are continued: not those beside another surface, if others are left.
MaskImage unmixed(const MaskImage& is_plane) {
  MaskImage inner = is_plane;
  for (int i = 0; i < kMixed; ++i) inner = shrunk(inner);
  const std::span<const std::uint8_t> pixels = inner.pixels();
  const bool is_left = std::any_of(pixels.begin(), pixels.end(), [](auto v) { return v != 0; });
  return is_left ? inner : is_plane;
}

/// One area as a grid of points.
class AreaGrid {
 public:
  AreaGrid(const SupportArea& area, double cell) : area_(area), cell_(cell) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector3d& corner : area.outline_base) box.extend(corner.head<2>());
    cell_ = std::max(cell, box.sizes().maxCoeff() / kMaxSide);
    first_ = box.min();
    columns_ = static_cast<int>(std::ceil(box.sizes().x() / cell_)) + 1;
    rows_ = static_cast<int>(std::ceil(box.sizes().y() / cell_)) + 1;
  }

  void append_unseen(const SurfaceQuery& surface, const TriangleMesh& mesh,
                     const std::vector<DepthView>& views, TriangleMesh& result) const {
    ColorImage colors(columns_, rows_);
    MaskImage is_plane(columns_, rows_);
    MaskImage is_on_scan(columns_, rows_);
    MaskImage is_gap(columns_, rows_);
    MaskImage is_unseen(columns_, rows_);
    bool has_unseen = false;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        const Eigen::Vector3d p = point(x, y);
        const auto near = surface.closest(p.cast<float>(), static_cast<float>(1.5 * cell_));
        if (near && is_along_plane(mesh, near->triangle)) {
          colors(x, y) = mesh.colors[mesh.triangles[near->triangle][0]];
          is_plane(x, y) = 1;
        }
        is_on_scan(x, y) = near && static_cast<double>(near->distance) < 0.5 * cell_ ? 1 : 0;
        if (is_on_scan(x, y) != 0 || !is_inside(area_.outline_base, p)) continue;
        const Evidence evidence = evidence_of_all(p, views);
        is_unseen(x, y) = evidence == Evidence::hidden_by_dynamic ? 1 : 0;
        is_gap(x, y) = evidence == Evidence::none && near ? 1 : 0;
        has_unseen = has_unseen || is_unseen(x, y) != 0;
      }
    }
    if (!has_unseen) return;
    const MaskImage is_known = unmixed(is_plane);
    fill_gaps(colors, is_known);
    for (int i = 0; i < kGap; ++i) is_unseen = grown_into(is_unseen, is_gap);
    // A point counts as on the scan up to half a square beyond the scan's edge.
    is_unseen = grown_into(is_unseen, is_on_scan);
    synthesise_grain(colors, is_known, is_unseen);
    append_squares(is_unseen, colors, result);
  }

 private:
  [[nodiscard]] Eigen::Vector3d point(int x, int y) const {
    const Eigen::Vector2d at = first_ + cell_ * Eigen::Vector2d(x, y);
    const Eigen::Vector3d& n = area_.plane_base.normal;
    return {at.x(), at.y(), (area_.plane_base.offset - n.head<2>().dot(at)) / n.z()};
  }

  [[nodiscard]] bool is_along_plane(const TriangleMesh& mesh, std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Eigen::Vector3f normal = (mesh.vertices[b] - mesh.vertices[a])
                                       .cross(mesh.vertices[c] - mesh.vertices[a])
                                       .normalized();
    return std::abs(normal.dot(area_.plane_base.normal.cast<float>())) > kMinCosine;
  }

  [[nodiscard]] static Evidence evidence_of_all(const Eigen::Vector3d& p,
                                                const std::vector<DepthView>& views) {
    Evidence all = Evidence::none;
    for (const DepthView& view : views) {
      all = std::max(all, evidence_of(view, p));
      if (all == Evidence::seen_through) break;
    }
    return all;
  }

  /// The squares with an unseen corner: those at the rim reach below the scan.
  void append_squares(const MaskImage& is_unseen, const ColorImage& colors,
                      TriangleMesh& result) const {
    Image<std::int64_t> index(columns_, rows_, -1);
    const auto vertex = [&](int x, int y) {
      if (index(x, y) < 0) {
        index(x, y) = static_cast<std::int64_t>(result.vertices.size());
        const Eigen::Vector3d p = point(x, y) - kBelow * area_.plane_base.normal;
        result.vertices.push_back(p.cast<float>());
        result.normals.push_back(area_.plane_base.normal.cast<float>());
        result.colors.push_back(colors(x, y));
      }
      return static_cast<std::uint32_t>(index(x, y));
    };
    for (int y = 0; y + 1 < rows_; ++y) {
      for (int x = 0; x + 1 < columns_; ++x) {
        if ((is_unseen(x, y) | is_unseen(x + 1, y) | is_unseen(x, y + 1) |
             is_unseen(x + 1, y + 1)) == 0) {
          continue;
        }
        const std::uint32_t a = vertex(x, y);
        const std::uint32_t b = vertex(x + 1, y);
        const std::uint32_t c = vertex(x + 1, y + 1);
        const std::uint32_t d = vertex(x, y + 1);
        result.triangles.push_back({a, b, c});
        result.triangles.push_back({a, c, d});
      }
    }
  }

  const SupportArea& area_;
  double cell_;
  Eigen::Vector2d first_;
  int columns_ = 0;
  int rows_ = 0;
};

}  // namespace

TriangleMesh find_unseen_support(const std::vector<SupportArea>& areas,
                                 const TriangleMesh& static_mesh_base,
                                 const std::vector<TextureView>& views,
                                 const CameraModel& color_camera, double cell) {
  TriangleMesh result;
  const bool has_dynamic = std::any_of(
      views.begin(), views.end(), [](const TextureView& view) { return !view.is_dynamic.empty(); });
  if (!has_dynamic || static_mesh_base.colors.empty()) return result;
  std::vector<DepthView> from;
  from.reserve(views.size());
  for (const TextureView& view : views) {
    from.push_back({&view, on_grid(color_camera, view.depth.width(), view.depth.height()),
                    view.T_base_camera.inverse()});
  }
  const SurfaceQuery surface(static_mesh_base);
  for (const SupportArea& area : areas) {
    if (area.outline_base.size() < 3 || !(area.plane_base.normal.z() > 0.1)) continue;
    AreaGrid(area, cell).append_unseen(surface, static_mesh_base, from, result);
  }
  return result;
}

}  // namespace pcavr
