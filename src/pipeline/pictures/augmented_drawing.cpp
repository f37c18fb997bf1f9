// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "augmented_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pcavr/perception/scene/palette.hpp"
#include "pcavr/perception/scene/preview_parts.hpp"

namespace pcavr {
namespace {

constexpr int kPerPixel = 2;  ///< samples along each side of a pixel (supersampling)
constexpr std::size_t kRowsPerTask = 8;

constexpr float kFillShare = 0.4F;
constexpr float kEdgeShare = 0.9F;
constexpr float kGhostShare = 0.9F;
/// Opacity of an occluded body, as a share of its usual opacity.
constexpr float kOccludedOpacity = 0.3F;
/// Recorded depth occludes a body that is farther by more than this [m] and this share: above a
/// depth camera's error and a tracked pose's.
constexpr float kOcclusionDistance = 0.02F;
constexpr float kOcclusionShare = 0.01F;

/// Faces at a larger angle than this have an edge between them: those of a 16-sided cylinder do
/// not.
const float kEdgeCosine = std::cos(0.5F);
/// A depth discontinuity between two samples: a step of more than this [m] or this share.
constexpr float kJump = 0.002F;
constexpr float kJumpShare = 0.005F;

struct Sample {
  Eigen::Vector3f normal_camera = Eigen::Vector3f::Zero();
  float depth = std::numeric_limits<float>::infinity();  ///< along the optical axis [m]
  std::uint8_t body = 0;                                 ///< from 1; 0: none
};

/// Pixel position of sample (x, y) of a window: the centre of its quarter of the pixel.
Eigen::Vector2d pixel_of(const PixelRectangle& window, int x, int y) {
  const auto at = [](int first, int sample) { return first + (sample + 0.5) / kPerPixel - 0.5; };
  return {at(window.x_begin, x), at(window.y_begin, y)};
}

PixelRectangle joined(const PixelRectangle& a, const PixelRectangle& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x_begin, b.x_begin), std::min(a.y_begin, b.y_begin),
          std::max(a.x_end, b.x_end), std::max(a.y_end, b.y_end)};
}

PixelRectangle window_of(const std::vector<BodyInView>& bodies, const CameraModel& camera) {
  PixelRectangle window;
  for (const BodyInView& body : bodies) {
    window = joined(
        window, visible_rectangle(body.surface->bounds(), camera, body.T_camera_object.inverse()));
  }
  return window;
}

/// Some bodies rendered by ray casting into a camera, with several samples per pixel.
class BodySamples {
 public:
  BodySamples(const std::vector<BodyInView>& bodies, const CameraModel& camera,
              Parallelism parallelism)
      : window_(window_of(bodies, camera)),
        samples_(std::max(0, kPerPixel * (window_.x_end - window_.x_begin)),
                 std::max(0, kPerPixel * (window_.y_end - window_.y_begin))) {
    rays_ = Image<Eigen::Vector3f>(samples_.width(), samples_.height(), Eigen::Vector3f::Zero());
    is_edge_ = MaskImage(samples_.width(), samples_.height());
    for_rows(parallelism, [&](int y) { find_rays(y, camera); });
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const PixelRectangle rectangle = visible_rectangle(bodies[i].surface->bounds(), camera,
                                                         bodies[i].T_camera_object.inverse());
      for_rows(parallelism,
               [&](int y) { cast_row(y, bodies[i], static_cast<std::uint8_t>(i + 1), rectangle); });
    }
    for_rows(parallelism, [&](int y) {
      for (int x = 0; x < samples_.width(); ++x) is_edge_(x, y) = has_border(x, y) ? 1 : 0;
    });
  }

  [[nodiscard]] const PixelRectangle& window() const { return window_; }

  /// One sample; an empty one outside the window.
  [[nodiscard]] const Sample& at(int x, int y) const {
    static const Sample kNone;
    return samples_.contains(x, y) ? samples_(x, y) : kNone;
  }

  /// Whether an edge line passes here: on the nearer side of a border between two samples.
  [[nodiscard]] bool is_edge(int x, int y) const {
    return is_edge_.contains(x, y) && is_edge_(x, y) != 0;
  }

 private:
  template <typename Row>
  void for_rows(Parallelism parallelism, Row row) {
    parallel_for(parallelism, static_cast<std::size_t>(samples_.height()), kRowsPerTask,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t y = begin; y < end; ++y) row(static_cast<int>(y));
                 });
  }

  void find_rays(int y, const CameraModel& camera) {
    for (int x = 0; x < samples_.width(); ++x) {
      rays_(x, y) = camera.unproject(pixel_of(window_, x, y), 1.0).cast<float>();
    }
  }

  void cast_row(int y, const BodyInView& body, std::uint8_t number,
                const PixelRectangle& rectangle) {
    const int pixel_y = window_.y_begin + y / kPerPixel;
    if (pixel_y < rectangle.y_begin || pixel_y >= rectangle.y_end) return;
    const Pose T_object_camera = body.T_camera_object.inverse();
    const Eigen::Matrix3f R_object_camera = T_object_camera.rotation_matrix().cast<float>();
    const Eigen::Vector3f origin = T_object_camera.translation().cast<float>();
    const int x_end = kPerPixel * (rectangle.x_end - window_.x_begin);
    for (int x = kPerPixel * (rectangle.x_begin - window_.x_begin); x < x_end; ++x) {
      const auto hit = body.surface->cast(origin, R_object_camera * rays_(x, y));
      if (!hit) continue;
      const float depth = hit->distance / rays_(x, y).norm();
      if (depth >= samples_(x, y).depth) continue;
      samples_(x, y) = {R_object_camera.transpose() * hit->normal, depth, number};
    }
  }

  [[nodiscard]] bool has_border(int x, int y) const {
    if (samples_(x, y).body == 0) return false;
    constexpr std::array<std::array<int, 2>, 4> kAround{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    return std::any_of(kAround.begin(), kAround.end(), [&](const std::array<int, 2>& step) {
      return is_border(x, y, x + step[0], y + step[1]);
    });
  }

  [[nodiscard]] bool is_border(int x, int y, int x_next, int y_next) const {
    // The window is wider than the bodies, except at the image border.
    if (!samples_.contains(x_next, y_next)) return false;
    const Sample& here = samples_(x, y);
    const Sample& next = samples_(x_next, y_next);
    if (next.body != here.body) return here.depth <= next.depth;
    if (here.normal_camera.dot(next.normal_camera) < kEdgeCosine) return true;
    // Depth of this sample's tangent plane at the next ray.
    const float slope = here.normal_camera.dot(rays_(x_next, y_next));
    if (slope == 0.0F) return false;
    const float expected = here.depth * here.normal_camera.dot(rays_(x, y)) / slope;
    return next.depth - expected > std::max(kJump, kJumpShare * here.depth);
  }

  PixelRectangle window_;
  Image<Sample> samples_;
  Image<Eigen::Vector3f> rays_;  ///< in camera axes, z = 1
  MaskImage is_edge_;
};

Eigen::Vector3f to_vector(const Rgb8& color) { return Eigen::Vector3f(color.r, color.g, color.b); }

std::uint8_t to_byte(float channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0F, 255.0F)));
}

void blend(Eigen::Vector3f& color, const Eigen::Vector3f& over, float share) {
  color += share * (over - color);
}

/// Edge lines of solid bodies are three samples wide: 1.5 pixels.
bool is_near_edge(const BodySamples& bodies, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (bodies.is_edge(x + dx, y + dy)) return true;
    }
  }
  return false;
}

/// The samples of one kind of bodies, addressed by sample coordinates of the whole picture.
struct Layer {
  const BodySamples& bodies;

  [[nodiscard]] int x(int sample) const { return sample - kPerPixel * bodies.window().x_begin; }
  [[nodiscard]] int y(int sample) const { return sample - kPerPixel * bodies.window().y_begin; }
};

/// Draws both layers over `color`, the recorded colour of one sample.
void paint(Eigen::Vector3f& color, const Layer& solid, const Layer& ghosts, float recorded_depth,
           int sample_x, int sample_y) {
  const int x = solid.x(sample_x);
  const int y = solid.y(sample_y);
  const Sample& body = solid.bodies.at(x, y);
  const bool is_occluded =
      body.body != 0 && recorded_depth > 0.0F &&
      recorded_depth * (1.0F + kOcclusionShare) + kOcclusionDistance < body.depth;
  const float opacity = is_occluded ? kOccludedOpacity : 1.0F;
  if (body.body != 0) {
    // Shaded by a light at the camera, so that faces differ.
    const float light = 0.65F + 0.35F * std::abs(body.normal_camera.z());
    blend(color, light * to_vector(kPredictedColor), opacity * kFillShare);
  }
  if (ghosts.bodies.is_edge(ghosts.x(sample_x), ghosts.y(sample_y))) {
    blend(color, to_vector(kTrackedColor), kGhostShare);
  }
  if (is_near_edge(solid.bodies, x, y))
    blend(color, to_vector(kPredictedColor), opacity * kEdgeShare);
}

}  // namespace

void draw_bodies(ColorImage& picture, const DepthImage& depth, const CameraModel& camera,
                 const std::vector<BodyInView>& solid, const std::vector<BodyInView>& ghosts,
                 Parallelism parallelism) {
  const BodySamples solid_samples(solid, camera, parallelism);
  const BodySamples ghost_samples(ghosts, camera, parallelism);
  PixelRectangle window = joined(solid_samples.window(), ghost_samples.window());
  // Lines extend a pixel beyond their bodies.
  window = {std::max(0, window.x_begin - 1), std::max(0, window.y_begin - 1),
            std::min(picture.width(), window.x_end + 1),
            std::min(picture.height(), window.y_end + 1)};
  if (window.empty()) return;
  const Layer solid_layer{solid_samples};
  const Layer ghost_layer{ghost_samples};
  const auto paint_pixel = [&](int x, int y) {
    const float recorded = depth.empty() ? 0.0F : depth(x, y);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int part = 0; part < kPerPixel * kPerPixel; ++part) {
      Eigen::Vector3f color = to_vector(picture(x, y));
      paint(color, solid_layer, ghost_layer, recorded, kPerPixel * x + part % kPerPixel,
            kPerPixel * y + part / kPerPixel);
      sum += color;
    }
    sum /= kPerPixel * kPerPixel;
    picture(x, y) = {to_byte(sum.x()), to_byte(sum.y()), to_byte(sum.z())};
  };
  parallel_for(parallelism, static_cast<std::size_t>(window.y_end - window.y_begin), kRowsPerTask,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t row = begin; row < end; ++row) {
                   for (int x = window.x_begin; x < window.x_end; ++x) {
                     paint_pixel(x, window.y_begin + static_cast<int>(row));
                   }
                 }
               });
}

void draw_legend(ColorImage& picture, bool has_solid, bool has_ghosts) {
  constexpr double kFromLeft = 60.0;
  constexpr double kLine = 30.0;
  constexpr int kMinHeight = 240;  // in a smaller picture, labels would cover the bodies
  if (picture.height() < kMinHeight) return;
  double y = picture.height() - 10.0;
  if (has_ghosts) {
    draw_label(picture, {kFromLeft, y}, "tracked", kTrackedColor);
    y -= kLine;
  }
  if (has_solid)
    draw_label(picture, {kFromLeft, y}, has_ghosts ? "predicted" : "body", kPredictedColor);
}

}  // namespace pcavr
