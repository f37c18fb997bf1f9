// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/texture/texture_options.hpp"

namespace pcavr {

/// An image that a texture is made from.
struct TextureView {
  ColorImage color;
  DepthImage depth;      ///< [m]; of the colour's size, or on a coarser grid (depth_grid.hpp)
  MaskImage is_dynamic;  ///< of the depth's size; empty: no pixel
  Pose T_base_camera;    ///< of the depth camera
  double sharpness = 0.0;
};

/// Camera that took the colour images, and its pose relative to the depth camera.
struct ColorRegistration {
  CameraModel camera;
  Pose T_color_depth;
  /// The images are darker by this share of their colours times the squared distance from the
  /// principal point in focal lengths.
  double vignetting = 0.0;
  /// False: the colours were found where the recording states them.
  bool is_estimated = false;
};

/// What a view's colours are multiplied with, and what is added, so that they agree with the
/// others'.
struct ViewExposure {
  Eigen::Vector3f gain = Eigen::Vector3f::Ones();    ///< by channel
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();  ///< by channel, of 255
};

/// Coordinates by vertex in the unit square, with the origin at the texture's upper left corner (as
/// in glTF).
using TextureCoordinates = std::vector<Eigen::Vector2f>;

/// The texture that all levels of detail of a mesh share.
struct MeshTexture {
  ColorImage image;                             ///< sRGB
  std::vector<TextureCoordinates> coordinates;  ///< by level
  ColorRegistration registration;
  std::vector<ViewExposure> exposures;  ///< by view; empty where nothing was painted
  std::size_t views = 0;
  double texel = 0.0;          ///< root mean square edge of a texel [m]
  double seen_fraction = 0.0;  ///< of these, with colours from an image
  [[nodiscard]] bool empty() const { return image.empty(); }
};

/// Paints a texture for the levels of a static mesh (finest first). Their vertices between two
/// charts are duplicated; they keep their colours. A texel's colour is a robust mean over the views
/// in which its depth is measured there and nothing dynamic hides it, with weights by resolution,
/// angle, sharpness, and distance from dynamic pixels; where no view sees it, the fused colour of
/// the vertices. Beforehand the views' exposures are evened out, and the offset of colour from
/// depth and the views' poses refined by photometric consistency [Zhou & Koltun 2014, sec. 4].
/// Empty, with the levels unchanged, where there is no view, no triangle or no colour. Bitwise
/// identical for any Parallelism.
[[nodiscard]] MeshTexture paint_texture(std::vector<TriangleMesh>& levels_base,
                                        const std::vector<TextureView>& views,
                                        const CameraModel& color_camera,
                                        const DepthNoise& depth_noise,
                                        const TextureOptions& options, Parallelism parallelism);

/// A view of a body that may move, and the body's pose in it.
struct BodyView {
  std::size_t view = 0;  ///< index of the TextureView
  Pose T_body_camera;    ///< of the depth camera
};

/// Paints the texture of a rigid body, from the views that show it at a known pose, with the
/// registration and the exposures of the static mesh's texture (`scene`). The mesh is in the body's
/// frame, with normals; vertices between two charts are duplicated. Where no view sees the body it
/// has the colours of the mesh's vertices. The atlas is at most `max_edge` [px] wide and high.
/// Empty, with the mesh unchanged, as paint_texture. Bitwise identical for any Parallelism.
[[nodiscard]] MeshTexture paint_body(TriangleMesh& mesh_body, const std::vector<TextureView>& views,
                                     const std::vector<BodyView>& seen_in, const MeshTexture& scene,
                                     int max_edge, const DepthNoise& depth_noise,
                                     const TextureOptions& options, Parallelism parallelism);

}  // namespace pcavr
