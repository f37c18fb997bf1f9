// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/perception/texture/mesh_texture.hpp"

namespace pcavr {

/// A point of the surface as a view sees it.
struct Sighting {
  Eigen::Vector2f pixel;  ///< of the colour image
  float weight = 0.0F;    ///< > 0
  bool is_mixed = false;  ///< the colour may be, in part, that of a nearer surface beside it
};

/// A colour as recorded, and where in the image.
struct RawColor {
  Eigen::Vector3f value;       ///< by channel, of 255
  float squared_slope = 0.0F;  ///< see PaintedView::squared_slope
};

/// A view with what is needed to look up surface points in it. const members are thread-safe.
class PaintedView {
 public:
  PaintedView(const TextureView& view, const ColorRegistration& registration,
              const DepthNoise& depth_noise, const TextureOptions& options);
  /// The view of a body that may move: points and normals are in the body's frame instead of base.
  /// The view's mask does not count, as the body is part of it.
  PaintedView(const TextureView& view, const Pose& T_body_camera,
              const ColorRegistration& registration, const DepthNoise& depth_noise,
              const TextureOptions& options);

  void set_registration(const ColorRegistration& registration);
  /// Corrects the pose of the colour camera: T_view_corrected is applied after T_camera_base.
  void set_correction(const Pose& T_corrected_camera);
  [[nodiscard]] const Pose& correction() const { return T_corrected_camera_; }

  /// Renders what of the surface the colour camera sees: from beside the depth camera, other parts
  /// are hidden. Call it again when the registration or the correction changes.
  void set_surface(const TriangleMesh& surface_base);

  /// False where no point of a ball can be in view.
  [[nodiscard]] bool may_see(const Eigen::Vector3f& center_base, float radius) const;

  /// nullopt where the point is out of view, seen from behind or too flatly, hidden, or dynamic;
  /// where its weight is less than `min_weight`, nullopt or the sighting.
  [[nodiscard]] std::optional<Sighting> look_up(const Eigen::Vector3f& p_base,
                                                const Eigen::Vector3f& normal_base,
                                                float min_weight = 0.0F) const;

  /// Whether the point is hidden by a measured surface whose edge is within two pixels: what was
  /// fused there has that one's colour in part.
  [[nodiscard]] bool is_behind_edge(const Eigen::Vector3f& p_base) const;

  /// The recorded colour at a pixel inside the image, bilinear.
  [[nodiscard]] RawColor raw_color_at(const Eigen::Vector2f& pixel) const;
  /// The colour with the view's vignetting, gain and offset made up for.
  [[nodiscard]] Eigen::Vector3f evened_out(const RawColor& raw) const;
  /// An evened out colour by cubic convolution, which does not blur [Keys 1981]; a pixel from the
  /// border.
  [[nodiscard]] Eigen::Vector3f sharp_color_at(const Eigen::Vector2f& pixel) const;
  /// Factor by which the vignetting's loss is made up for.
  [[nodiscard]] float brightening(float squared_slope) const;
  /// Square of the pixel's distance from the principal point [focal lengths squared].
  [[nodiscard]] float squared_slope(const Eigen::Vector2f& pixel) const;
  /// The pixel of a point in the image; empty outside, and where the sensor was saturated.
  [[nodiscard]] std::optional<Eigen::Vector2f> exposed_pixel(const Eigen::Vector3f& p_base) const;

  [[nodiscard]] Eigen::Vector3d in_color_camera(const Eigen::Vector3f& p_base) const;
  [[nodiscard]] const CameraModel& color_camera() const { return registration_.camera; }
  [[nodiscard]] const TextureView& view() const { return *view_; }
  /// Pixels per metre at a distance of 1 m.
  [[nodiscard]] float focal() const { return static_cast<float>(registration_.camera.fx); }
  [[nodiscard]] Eigen::Vector3f position_base() const { return position_base_; }

  /// The camera's: see ColorRegistration.
  float vignetting = 0.0F;
  /// Gain and offset by channel: an evened out colour is gain * brightening * color + offset, of
  /// 255.
  Eigen::Vector3f gain = Eigen::Vector3f::Ones();
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();
  float sharpness_weight = 1.0F;

 private:
  PaintedView(const TextureView& view, const ColorRegistration& registration,
              const DepthNoise& depth_noise, const TextureOptions& options,
              const Pose& T_base_camera, bool uses_mask);
  /// Whether the sensor was saturated there: the surface is at least as bright as the colour.
  [[nodiscard]] bool is_overexposed(const Eigen::Vector2f& pixel) const;
  void set_camera_pose(const Pose& T_base_camera);
  void update_color_pose();
  /// Share of its weight that a sighting keeps because of what lies in front of the point in the
  /// colour image; 0 where that hides it. `tolerance` in m.
  [[nodiscard]] float share_seen(const Eigen::Vector2f& pixel, float depth, float tolerance) const;

  /// Largest distance of a measured depth from the surface's [m].
  [[nodiscard]] float tolerance_at(float depth) const;
  /// Whether a pixel beside one of the depth image has a depth in (from, to) [m].
  [[nodiscard]] bool touches_depth(int x, int y, float from, float to) const;

  const TextureView* view_;
  ColorRegistration registration_;
  Pose T_camera_base_;
  Pose T_corrected_camera_;
  CameraModel depth_camera_;
  DepthNoise noise_;
  float mask_distance_;
  DepthImage nearest_;          ///< smallest depth around each pixel [m]
  DepthImage surface_;          ///< in the colour camera, on a coarser grid [m]
  DepthImage nearest_surface_;  ///< the smallest around each pixel [m]
  int pixels_per_surface_pixel_ = 1;
  Image<std::uint8_t> from_dynamic_;  ///< distance from dynamic pixels [px of depth], to 255
  Eigen::Matrix3f R_camera_base_;
  Eigen::Vector3f t_camera_base_;
  Eigen::Matrix3f R_color_base_;
  Eigen::Vector3f t_color_base_;
  Eigen::Vector3f position_base_;
};

/// Sets sharpness_weight: a view that is less sharp than those before and after it counts less.
void weigh_sharpness(std::vector<PaintedView>& views);

}  // namespace pcavr
