// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "painted_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/pixel.hpp"

#include "draw_depth.hpp"

namespace pcavr {
namespace {

constexpr float kNear = 0.05F;       ///< [m]
constexpr float kMinCosine = 0.17F;  ///< of the incidence, 80 degrees
constexpr float kBorder = 24.0F;     ///< [px] within which a view fades out
constexpr float kDoubtful = 0.05F;   ///< weight without depth, and next to a nearer surface
constexpr int kEdgeRadius = 3;       ///< [px] of depth: its edges are that uncertain
/// [px] of depth from an edge: a pixel that sees both sides, and one by interpolation.
constexpr int kMixedRadius = 2;
/// [px]; the fused surface's edges are no finer.
constexpr int kMaxSurfaceWidth = 320;
/// Errors of poses and of the fused surface, beside the sensor's noise [m].
constexpr float kSurfaceError = 0.008F;
constexpr float kNoiseFactor = 3.0F;  ///< [std]
constexpr std::uint8_t kMaxDistance = 255;
constexpr std::uint8_t kSaturated = 250;  ///< JPEG leaves it a little below 255

/// The smallest positive value in a square window; a row, then a column filter.
DepthImage minimum_around(const DepthImage& depth, int radius) {
  using Row = Eigen::ArrayXf;
  constexpr float kNone = std::numeric_limits<float>::infinity();  // larger than any depth
  const auto width = static_cast<Eigen::Index>(depth.width());
  const int window = 2 * radius + 1;
  std::vector<Row> rows(static_cast<std::size_t>(window), Row::Constant(width, kNone));
  Row padded = Row::Constant(width + window - 1, kNone);
  DepthImage nearest(depth.width(), depth.height());
  // Row y + radius enters the window, in place of the one that leaves it.
  for (int y = -radius; y < depth.height(); ++y) {
    Row& entering = rows[static_cast<std::size_t>((y + radius) % window)];
    if (y + radius < depth.height()) {
      const Eigen::Map<const Row> row(depth.row(y + radius).data(), width);
      padded.segment(radius, width) = (row > 0.0F).select(row, kNone);
      entering = padded.head(width);
      for (int i = 1; i < window; ++i) entering = entering.min(padded.segment(i, width));
    } else {
      entering = kNone;
    }
    if (y < 0) continue;
    Eigen::Map<Row> smallest(nearest.row(y).data(), width);
    smallest = rows.front();
    for (const Row& row : rows) smallest = smallest.min(row);
    smallest = (smallest < kNone).select(smallest, 0.0F);
  }
  return nearest;
}

/// City-block distance from the mask's pixels by two passes [Rosenfeld & Pfaltz 1966].
Image<std::uint8_t> distance_from(const MaskImage& mask) {
  Image<std::uint8_t> distance(mask.width(), mask.height(), kMaxDistance);
  const auto relax = [&](int x, int y, int other_x, int other_y) {
    if (!distance.contains(other_x, other_y)) return;
    const int next = std::min<int>(kMaxDistance, distance(other_x, other_y) + 1);
    distance(x, y) = static_cast<std::uint8_t>(std::min<int>(distance(x, y), next));
  };
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) != 0) distance(x, y) = 0;
      relax(x, y, x - 1, y);
      relax(x, y, x, y - 1);
    }
  }
  for (int y = mask.height() - 1; y >= 0; --y) {
    for (int x = mask.width() - 1; x >= 0; --x) {
      relax(x, y, x + 1, y);
      relax(x, y, x, y + 1);
    }
  }
  return distance;
}

Eigen::Vector2f project(const CameraModel& camera, const Eigen::Vector3f& p_camera) {
  if (camera.has_distortion()) return camera.project(p_camera.cast<double>().eval()).cast<float>();
  return {
      static_cast<float>(camera.fx) * p_camera.x() / p_camera.z() + static_cast<float>(camera.cx),
      static_cast<float>(camera.fy) * p_camera.y() / p_camera.z() + static_cast<float>(camera.cy)};
}

/// Weights of the four samples around an offset in [0, 1] from the second one.
Eigen::Array4f cubic_weights(float u) {
  return {((1.0F - 0.5F * u) * u - 0.5F) * u, (1.5F * u - 2.5F) * u * u + 1.0F,
          ((2.0F - 1.5F * u) * u + 0.5F) * u, 0.5F * (u - 1.0F) * u * u};
}

}  // namespace

PaintedView::PaintedView(const TextureView& view, const ColorRegistration& registration,
                         const DepthNoise& depth_noise, const TextureOptions& options)
    : PaintedView(view, registration, depth_noise, options, view.T_base_camera, true) {}

PaintedView::PaintedView(const TextureView& view, const Pose& T_body_camera,
                         const ColorRegistration& registration, const DepthNoise& depth_noise,
                         const TextureOptions& options)
    : PaintedView(view, registration, depth_noise, options, T_body_camera, false) {}

PaintedView::PaintedView(const TextureView& view, const ColorRegistration& registration,
                         const DepthNoise& depth_noise, const TextureOptions& options,
                         const Pose& T_base_camera, bool uses_mask)
    : view_(&view),
      registration_(registration),
      depth_camera_(on_grid(registration.camera, view.depth.width(), view.depth.height())),
      noise_(depth_noise),
      // The distance is in depth pixels.
      mask_distance_(static_cast<float>(options.mask_distance * depth_camera_.width /
                                        registration.camera.width)),
      nearest_(minimum_around(view.depth, kEdgeRadius)) {
  if (uses_mask && !view.is_dynamic.empty()) from_dynamic_ = distance_from(view.is_dynamic);
  set_camera_pose(T_base_camera);
}

void PaintedView::set_camera_pose(const Pose& T_base_camera) {
  T_camera_base_ = T_base_camera.inverse();
  R_camera_base_ = T_camera_base_.rotation_matrix().cast<float>();
  t_camera_base_ = T_camera_base_.translation().cast<float>();
  position_base_ = T_base_camera.translation().cast<float>();
  update_color_pose();
}

void PaintedView::set_registration(const ColorRegistration& registration) {
  registration_ = registration;
  update_color_pose();
}

void PaintedView::set_correction(const Pose& T_corrected_camera) {
  T_corrected_camera_ = T_corrected_camera;
  update_color_pose();
}

void PaintedView::update_color_pose() {
  const Pose T_color_base = registration_.T_color_depth * T_corrected_camera_ * T_camera_base_;
  R_color_base_ = T_color_base.rotation_matrix().cast<float>();
  t_color_base_ = T_color_base.translation().cast<float>();
}

Eigen::Vector3d PaintedView::in_color_camera(const Eigen::Vector3f& p_base) const {
  return (R_color_base_ * p_base + t_color_base_).cast<double>();
}

void PaintedView::set_surface(const TriangleMesh& surface_base) {
  const CameraModel& camera = registration_.camera;
  const Pose T_color_base = registration_.T_color_depth * T_corrected_camera_ * T_camera_base_;
  pixels_per_surface_pixel_ = std::max(2, (camera.width + kMaxSurfaceWidth - 1) / kMaxSurfaceWidth);
  surface_ = draw_depth(surface_base,
                        on_grid(camera, camera.width / pixels_per_surface_pixel_,
                                camera.height / pixels_per_surface_pixel_),
                        T_color_base);
  nearest_surface_ = minimum_around(surface_, kEdgeRadius);
}

float PaintedView::share_seen(const Eigen::Vector2f& pixel, float depth, float tolerance) const {
  if (surface_.empty()) return 1.0F;
  const int x = static_cast<int>(pixel.x()) / pixels_per_surface_pixel_;
  const int y = static_cast<int>(pixel.y()) / pixels_per_surface_pixel_;
  if (!surface_.contains(x, y)) return 1.0F;
  const auto hides = [&](float nearer) { return nearer > 0.0F && nearer < depth - tolerance; };
  if (hides(surface_(x, y))) return 0.0F;
  return hides(nearest_surface_(x, y)) ? kDoubtful : 1.0F;
}

float PaintedView::tolerance_at(float depth) const {
  return kSurfaceError + kNoiseFactor * static_cast<float>(noise_.depth_std(depth));
}

bool PaintedView::may_see(const Eigen::Vector3f& center_base, float radius) const {
  const Eigen::Vector3f p = R_color_base_ * center_base + t_color_base_;
  if (p.z() < kNear - radius) return false;
  const CameraModel& camera = registration_.camera;
  if (camera.has_distortion()) return true;  // the view's border is curved
  const auto outside = [&](float along, double focal, double border) {
    // Distance from the plane through the eye and the image's border.
    const auto slope = static_cast<float>(border / focal);
    return along - slope * p.z() > radius * std::sqrt(1.0F + slope * slope);
  };
  return !outside(p.x(), camera.fx, camera.width - camera.cx) &&
         !outside(-p.x(), camera.fx, camera.cx) &&
         !outside(p.y(), camera.fy, camera.height - camera.cy) &&
         !outside(-p.y(), camera.fy, camera.cy);
}

std::optional<Sighting> PaintedView::look_up(const Eigen::Vector3f& p_base,
                                             const Eigen::Vector3f& normal_base,
                                             float min_weight) const {
  const Eigen::Vector3f p = R_camera_base_ * p_base + t_camera_base_;
  const float z = p.z();
  if (!(z > kNear)) return std::nullopt;
  const Eigen::Vector3f to_eye = position_base_ - p_base;
  const float cosine = normal_base.dot(to_eye) / to_eye.norm();
  if (!(cosine > kMinCosine)) return std::nullopt;
  float weight = cosine * cosine / (z * z) * sharpness_weight;
  if (weight < min_weight) return std::nullopt;  // what follows lowers it
  const Eigen::Vector2f at = project(depth_camera_, p);
  const std::optional<int> x = pixel_index(at.x(), depth_camera_.width);
  const std::optional<int> y = pixel_index(at.y(), depth_camera_.height);
  if (!x || !y) return std::nullopt;
  const float tolerance = tolerance_at(z);
  const float measured = view_->depth(*x, *y);
  const float tilted = tolerance / std::max(cosine, 0.3F);
  if (measured > 0.0F && std::abs(measured - z) > tilted) return std::nullopt;
  const bool is_beside_nearer = nearest_(*x, *y) > 0.0F && nearest_(*x, *y) < z - 2.0F * tilted;
  const bool is_measured = measured > 0.0F;
  if (!is_measured || is_beside_nearer) weight *= kDoubtful;
  if (!from_dynamic_.empty()) {
    const float distance = from_dynamic_(*x, *y);
    if (distance == 0.0F) return std::nullopt;
    if (distance < mask_distance_) {
      const float share = distance / mask_distance_;
      weight *= kDoubtful + (1.0F - kDoubtful) * share * share;
    }
  }
  if (weight < min_weight) return std::nullopt;
  const Eigen::Vector3f in_color = R_color_base_ * p_base + t_color_base_;
  if (!(in_color.z() > kNear)) return std::nullopt;
  const CameraModel& camera = registration_.camera;
  const Eigen::Vector2f pixel = project(camera, in_color);
  const float border =
      std::min(std::min(pixel.x(), static_cast<float>(camera.width - 1) - pixel.x()),
               std::min(pixel.y(), static_cast<float>(camera.height - 1) - pixel.y()));
  if (!(border > 1.0F)) return std::nullopt;
  weight *= share_seen(pixel, in_color.z(), 2.0F * tilted);
  if (!(weight > 0.0F)) return std::nullopt;
  weight *= std::min(1.0F, border / kBorder);
  const bool is_mixed =
      is_beside_nearer && (!is_measured || touches_depth(*x, *y, 0.0F, z - 2.0F * tilted));
  return Sighting{pixel, weight, is_mixed};
}

bool PaintedView::is_behind_edge(const Eigen::Vector3f& p_base) const {
  const Eigen::Vector3f p = R_camera_base_ * p_base + t_camera_base_;
  if (!(p.z() > kNear)) return false;
  const Eigen::Vector2f at = project(depth_camera_, p);
  const std::optional<int> x = pixel_index(at.x(), depth_camera_.width);
  const std::optional<int> y = pixel_index(at.y(), depth_camera_.height);
  if (!x || !y) return false;
  const float margin = 2.0F * tolerance_at(p.z());
  const float measured = view_->depth(*x, *y);
  return measured > 0.0F && measured < p.z() - margin &&
         touches_depth(*x, *y, p.z() - margin, p.z() + margin);
}

bool PaintedView::touches_depth(int x, int y, float from, float to) const {
  const DepthImage& measured = view_->depth;
  for (int at_y = y - kMixedRadius; at_y <= y + kMixedRadius; ++at_y) {
    for (int at_x = x - kMixedRadius; at_x <= x + kMixedRadius; ++at_x) {
      if (!measured.contains(at_x, at_y)) continue;
      if (measured(at_x, at_y) > from && measured(at_x, at_y) < to) return true;
    }
  }
  return false;
}

RawColor PaintedView::raw_color_at(const Eigen::Vector2f& pixel) const {
  const ColorImage& image = view_->color;
  const int x = std::clamp(static_cast<int>(pixel.x()), 0, image.width() - 2);
  const int y = std::clamp(static_cast<int>(pixel.y()), 0, image.height() - 2);
  const float u = pixel.x() - static_cast<float>(x);
  const float v = pixel.y() - static_cast<float>(y);
  const auto at = [&](int dx, int dy) {
    const Rgb8& c = image(x + dx, y + dy);
    return Eigen::Vector3f(c.r, c.g, c.b);
  };
  const Eigen::Vector3f above = (1.0F - u) * at(0, 0) + u * at(1, 0);
  const Eigen::Vector3f below = (1.0F - u) * at(0, 1) + u * at(1, 1);
  return {(1.0F - v) * above + v * below, squared_slope(pixel)};
}

Eigen::Vector3f PaintedView::evened_out(const RawColor& raw) const {
  return brightening(raw.squared_slope) * gain.cwiseProduct(raw.value) + offset;
}

Eigen::Vector3f PaintedView::sharp_color_at(const Eigen::Vector2f& pixel) const {
  const ColorImage& image = view_->color;
  const int x = std::clamp(static_cast<int>(pixel.x()), 1, image.width() - 3);
  const int y = std::clamp(static_cast<int>(pixel.y()), 1, image.height() - 3);
  const Eigen::Array4f along_x = cubic_weights(pixel.x() - static_cast<float>(x));
  const Eigen::Array4f along_y = cubic_weights(pixel.y() - static_cast<float>(y));
  // The first convolution is along y: all channels of four pixels at once.
  std::array<float, 12> columns{};
  for (int dy = 0; dy < 4; ++dy) {
    const Rgb8* row = &image(x - 1, y - 1 + dy);
    const float weight = along_y[dy];
    for (std::size_t i = 0; i < 4; ++i) {
      columns[3 * i] += weight * static_cast<float>(row[i].r);
      columns[3 * i + 1] += weight * static_cast<float>(row[i].g);
      columns[3 * i + 2] += weight * static_cast<float>(row[i].b);
    }
  }
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < 4; ++i)
    sum +=
        along_x[static_cast<Eigen::Index>(i)] * Eigen::Map<const Eigen::Vector3f>(&columns[3 * i]);
  return evened_out({sum, squared_slope(pixel)});
}

float PaintedView::squared_slope(const Eigen::Vector2f& pixel) const {
  const CameraModel& camera = registration_.camera;
  const float x = (pixel.x() - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx);
  const float y = (pixel.y() - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy);
  return x * x + y * y;
}

float PaintedView::brightening(float squared_slope) const {
  constexpr float kMinShare = 0.3F;  // of the light
  return 1.0F / std::max(kMinShare, 1.0F - vignetting * squared_slope);
}

std::optional<Eigen::Vector2f> PaintedView::exposed_pixel(const Eigen::Vector3f& p_base) const {
  const Eigen::Vector2d pixel = color_camera().project(in_color_camera(p_base));
  if (!color_camera().contains(pixel)) return std::nullopt;
  const Eigen::Vector2f found = pixel.cast<float>();
  return is_overexposed(found) ? std::nullopt : std::optional(found);
}

bool PaintedView::is_overexposed(const Eigen::Vector2f& pixel) const {
  const Rgb8& c = view_->color(static_cast<int>(std::lround(pixel.x())),
                               static_cast<int>(std::lround(pixel.y())));
  return std::max({c.r, c.g, c.b}) >= kSaturated;
}

void weigh_sharpness(std::vector<PaintedView>& views) {
  constexpr std::size_t kReach = 2;  // neighbouring views see about the same
  for (std::size_t i = 0; i < views.size(); ++i) {
    double sharpest = 0.0;
    const std::size_t end = std::min(views.size(), i + kReach + 1);
    for (std::size_t j = i < kReach ? 0 : i - kReach; j < end; ++j)
      sharpest = std::max(sharpest, views[j].view().sharpness);
    const double ratio = sharpest > 0.0 ? views[i].view().sharpness / sharpest : 1.0;
    views[i].sharpness_weight = static_cast<float>(std::max(0.05, ratio * ratio));
  }
}

}  // namespace pcavr
