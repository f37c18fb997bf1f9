// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/image_scaling.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/object_colors.hpp"
#include "pcavr/perception/scene/preview_parts.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

constexpr int kSupersampling = 2;  ///< along each axis: four samples a pixel smooth edges

// Ids in Canvas::id.
constexpr std::uint8_t kStatic = 1;
constexpr std::uint8_t kTrajectory = 2;
constexpr std::uint8_t kAxis = 3;
constexpr std::uint8_t kArm = 4;
constexpr std::uint8_t kFirstObject = 5;

constexpr double kAxisLength = 0.15;    ///< of the base frame's axes [m]
constexpr std::size_t kFrustums = 8;    ///< drawn along the camera trajectory
constexpr int kTrajectoryOpacity = 40;  ///< opacity of the camera trajectory [%]
constexpr int kArmOpacity = 75;         ///< [%]: what it hides remains visible
constexpr double kFrustumDepth = 0.04;  ///< [m]

Eigen::Vector3f as_vector(const Rgb8& c) { return Eigen::Vector3f(c.r, c.g, c.b) / 255.0F; }

/// Renders the preview image.
class PreviewRenderer {
 public:
  PreviewRenderer(const Scene& scene, Parallelism parallelism)
      : scene_(scene),
        object_colors_(object_colors(scene)),
        parallelism_(parallelism),
        view_(choose_view(scene, kPreviewWidth * kSupersampling, kPreviewHeight * kSupersampling)),
        canvas_(view_.camera.width, view_.camera.height),
        to_light_base_((view_.T_base_view.rotation() * Eigen::Vector3d(-0.4, -0.8, -0.7))
                           .normalized()
                           .cast<float>()) {}

  ColorImage render() {
    draw_background(canvas_);
    draw_scan();
    if (!scene_.unseen_support_base.triangles.empty()) draw_static(scene_.unseen_support_base);
    draw_objects();
    draw_arm();
    draw_base_axes();
    draw_contours(canvas_, kFirstObject, contour_colors());
    draw_camera_trajectory();
    ColorImage picture = halved(canvas_.color);
    draw_labels(picture);
    return picture;
  }

 private:
  void draw(const TriangleMesh& mesh, std::uint8_t id, const Shader& shader,
            const MeshImage* on_mesh = nullptr) {
    if (mesh.normals.empty()) {
      TriangleMesh with_normals = mesh;
      compute_vertex_normals(with_normals);
      draw_mesh(canvas_, view_, with_normals, id, shader, parallelism_, on_mesh);
    } else {
      draw_mesh(canvas_, view_, mesh, id, shader, parallelism_, on_mesh);
    }
  }

  /// Draws the scan as the page shows it: with the texture, where the scene has one.
  void draw_scan() {
    if (scene_.texture && !scene_.levels_of_detail_base.empty()) {
      const SceneTexture& texture = *scene_.texture;
      ImageDecoder decoder;
      const auto image = decoder.color(texture.jpeg, {"texture", texture.width, texture.height});
      if (image) {
        const MeshImage on_mesh{*image, texture.coordinates.front()};
        draw_static(scene_.levels_of_detail_base.front(), &on_mesh);
        return;
      }
    }
    draw_static(scene_.mesh_base);
  }

  [[nodiscard]] float lambert(const Eigen::Vector3f& normal) const {
    return std::max(0.0F, normal.dot(to_light_base_));
  }

  void draw_static(const TriangleMesh& mesh_base, const MeshImage* on_mesh = nullptr) {
    // The colours contain the scene's lighting; some additional shading shows the shape.
    const bool is_uncolored = mesh_base.colors.empty() && on_mesh == nullptr;
    const auto shader = [&](const Eigen::Vector3f& color, const Eigen::Vector3f& n) {
      const Eigen::Vector3f shaded = is_uncolored
                                         ? Eigen::Vector3f(color * (0.45F + 0.4F * lambert(n)))
                                         : Eigen::Vector3f(color * (0.88F + 0.24F * lambert(n)));
      return shaded;
    };
    draw(mesh_base, kStatic, shader, on_mesh);
  }

  void draw_objects() {
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const SceneObject& object = scene_.objects[i];
      if (object.evidence == kNotSeen) continue;
      const Eigen::Vector3f tint = as_vector(object_colors_[i]);
      const auto id = static_cast<std::uint8_t>(std::min<std::size_t>(kFirstObject + i, 255));
      if (draw_textured(object, id)) continue;
      draw(transformed(object.T_base_object, with_sharp_edges(object.model.mesh_object)), id,
           [&](const Eigen::Vector3f& color, const Eigen::Vector3f& n) {
             const Eigen::Vector3f mixed =
                 tint.cwiseProduct(0.4F * color + Eigen::Vector3f::Constant(0.6F));
             return Eigen::Vector3f(mixed * (0.62F + 0.42F * lambert(n)));
           });
    }
  }

  /// Draws an object as recorded; its contour is of its colour. False where it has no texture.
  bool draw_textured(const SceneObject& object, std::uint8_t id) {
    if (!object.texture) return false;
    const BodyTexture& texture = *object.texture;
    ImageDecoder decoder;
    const auto image = decoder.color(texture.jpeg, {"texture", texture.width, texture.height});
    if (!image) return false;
    const MeshImage on_mesh{*image, texture.coordinates};
    draw(
        transformed(object.T_base_object, texture.mesh_object), id,
        [&](const Eigen::Vector3f& color, const Eigen::Vector3f& n) {
          return Eigen::Vector3f(color * (0.88F + 0.24F * lambert(n)));
        },
        &on_mesh);
    return true;
  }

  /// By object: its colour where it is drawn with its texture.
  [[nodiscard]] std::vector<std::optional<Rgb8>> contour_colors() const {
    std::vector<std::optional<Rgb8>> colors(scene_.objects.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      if (scene_.objects[i].texture) colors[i] = object_colors_[i];
    }
    return colors;
  }

  /// The arm at the recording's end.
  void draw_arm() {
    if (!scene_.robot) return;
    const ColorImage before = canvas_.color;
    for (const SceneRobot::Link& link : scene_.robot->links) {
      draw(transformed(link.T_base_link, with_sharp_edges(link.mesh_link)), kArm,
           [&](const Eigen::Vector3f& color, const Eigen::Vector3f& n) {
             return Eigen::Vector3f(color * (0.5F + 0.38F * lambert(n)));
           });
    }
    blend(before, kArm, kArmOpacity);
  }

  /// Alpha blending of what was drawn as `id` over the canvas before.
  void blend(const ColorImage& before, std::uint8_t id, int opacity) {
    for (std::size_t i = 0; i < before.pixels().size(); ++i) {
      if (canvas_.id.pixels()[i] != id) continue;
      Rgb8& pixel = canvas_.color.pixels()[i];
      for (std::uint8_t Rgb8::*channel : {&Rgb8::r, &Rgb8::g, &Rgb8::b}) {
        pixel.*channel = static_cast<std::uint8_t>(
            (pixel.*channel * opacity + before.pixels()[i].*channel * (100 - opacity)) / 100);
      }
    }
  }

  /// A polyline, `pixels` wide at its start in the final image.
  void draw_line(const std::vector<Eigen::Vector3d>& line, double pixels, std::uint8_t id,
                 const Rgb8& color) {
    const double distance = (line.front() - view_.T_base_view.translation()).norm();
    const double radius = 0.5 * pixels * kSupersampling * distance / view_.camera.fx;
    const Eigen::Vector3f uniform = as_vector(color);
    draw_mesh(
        canvas_, view_, tubes(line, radius), id,
        [&](const Eigen::Vector3f&, const Eigen::Vector3f&) { return uniform; }, parallelism_);
  }

  void draw_base_axes() {
    const std::array<Rgb8, 3> colors = {{{214, 40, 40}, {34, 150, 60}, {36, 86, 214}}};
    for (int axis = 0; axis < 3; ++axis) {
      draw_line({Eigen::Vector3d::Zero(), kAxisLength * Eigen::Vector3d::Unit(axis)}, 4.0, kAxis,
                colors[static_cast<std::size_t>(axis)]);
    }
  }

  void draw_camera_trajectory() {
    const std::vector<TimedPose>& poses = scene_.camera_trajectory.poses();
    if (poses.empty()) return;
    const ColorImage before = canvas_.color;
    const Rgb8 color{20, 40, 90};
    std::vector<Eigen::Vector3d> positions;
    for (const TimedPose& pose : poses) positions.push_back(pose.pose.translation());
    draw_line(positions, 1.2, kTrajectory, color);
    const std::size_t count =
        scene_.quality.is_fixed_camera ? 1 : std::min(kFrustums, poses.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t index = count == 1 ? 0 : i * (poses.size() - 1) / (count - 1);
      draw_frustum(poses[index].pose, color);
    }
    // It is secondary, and may hide the scene.
    blend(before, kTrajectory, kTrajectoryOpacity);
  }

  void draw_frustum(const Pose& T_base_camera, const Rgb8& color) {
    // Aspect ratio of most depth cameras; the scene does not store the camera model.
    const double z = kFrustumDepth;
    const std::array<Eigen::Vector3d, 4> corners = {{{-0.6 * z, -0.45 * z, z},
                                                     {0.6 * z, -0.45 * z, z},
                                                     {0.6 * z, 0.45 * z, z},
                                                     {-0.6 * z, 0.45 * z, z}}};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      draw_line({T_base_camera.translation(), T_base_camera * corners[i],
                 T_base_camera * corners[(i + 1) % corners.size()]},
                1.2, kTrajectory, color);
    }
  }

  /// Top centre of a box in the final image; nullopt where it is behind the viewer.
  [[nodiscard]] std::optional<Eigen::Vector2d> top_centre_of(const Eigen::AlignedBox3d& box) const {
    Eigen::AlignedBox2d projected;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p_view =
          view_.T_base_view.inverse() *
          box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)).eval();
      if (p_view.z() <= 0.0) return std::nullopt;
      projected.extend(Eigen::Vector2d(view_.camera.project(p_view) / kSupersampling));
    }
    return Eigen::Vector2d(projected.center().x(), projected.min().y());
  }

  /// Median depth of the scan in the picture [m]; 0 without any. Half of what is seen is nearer:
  /// far scraps, which would move the middle of the mesh, hardly count.
  [[nodiscard]] double median_depth() const {
    std::vector<float> depths;
    for (std::size_t i = 0; i < canvas_.id.pixels().size(); ++i) {
      if (canvas_.id.pixels()[i] == kStatic) depths.push_back(canvas_.depth.pixels()[i]);
    }
    if (depths.empty()) return 0.0;
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    return static_cast<double>(*middle);
  }

  void draw_labels(ColorImage& picture) const {
    Eigen::AlignedBox3d objects;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const SceneObject& object = scene_.objects[i];
      if (object.evidence == kNotSeen) continue;
      const Eigen::AlignedBox3d box =
          bounds(transformed(object.T_base_object, object.model.mesh_object).vertices)
              .cast<double>();
      objects.extend(box);
      if (const auto at = top_centre_of(box)) {
        draw_label(picture, *at, object.model.name, object_colors_[i]);
      }
    }
    const double depth =
        objects.isEmpty() ? median_depth() : (view_.T_base_view.inverse() * objects.center()).z();
    if (depth > 0.0) draw_scale_bar(picture, view_.camera.fx / (kSupersampling * depth));
  }

  const Scene& scene_;
  std::vector<Rgb8> object_colors_;
  Parallelism parallelism_;
  View view_;
  Canvas canvas_;
  Eigen::Vector3f to_light_base_;
};

}  // namespace

ColorImage render_preview(const Scene& scene, Parallelism parallelism) {
  return PreviewRenderer(scene, parallelism).render();
}

}  // namespace pcavr
