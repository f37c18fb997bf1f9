// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/scene/preview.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/palette.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "scene/scene_builder.hpp"

namespace pcavr {
namespace {

View a_plain_view() { return {a_small_camera(), a_view_from_above()}; }

Pose looking_down_from(const Eigen::Vector3d& p_base) {
  return Pose(a_view_from_above().rotation(), p_base);
}

Eigen::Vector3f vertex_color(const Eigen::Vector3f& color, const Eigen::Vector3f&) { return color; }

TEST(Rasteriser, DrawsDepthAndColourWhereTheSurfaceIs) {
  Canvas canvas(160, 120);
  TriangleMesh table = a_level_square({0.5, 0.0, 0.0}, 0.4, 4);
  std::ranges::fill(table.colors, Rgb8{10, 200, 30});
  draw_mesh(canvas, a_plain_view(), table, 7, vertex_color, {1});
  EXPECT_NEAR(canvas.depth(80, 60), 1.0F, 1e-6F);
  EXPECT_EQ(canvas.color(80, 60), (Rgb8{10, 200, 30}));
  EXPECT_EQ(canvas.id(80, 60), 7);
  EXPECT_EQ(canvas.depth(2, 2), 0.0F);
  // 0.4 m at 1 m and 131.25 px: 52.5 pixels square.
  const auto drawn = std::ranges::count(canvas.id.pixels(), 7);
  EXPECT_NEAR(static_cast<double>(drawn), 52.5 * 52.5, 2 * 53.0);
}

TEST(Rasteriser, DepthTestsInAnyOrder) {
  const TriangleMesh low = a_level_square({0.5, 0.0, 0.0}, 0.4, 4);
  const TriangleMesh high = a_level_square({0.5, 0.0, 0.2}, 0.2, 4);
  for (const bool high_first : {false, true}) {
    Canvas canvas(160, 120);
    draw_mesh(canvas, a_plain_view(), high_first ? high : low, high_first ? 2 : 1, vertex_color,
              {1});
    draw_mesh(canvas, a_plain_view(), high_first ? low : high, high_first ? 1 : 2, vertex_color,
              {1});
    EXPECT_EQ(canvas.id(80, 60), 2);
  }
}

TEST(Rasteriser, CullsBackFacesAndWhatIsBehindTheViewer) {
  Canvas canvas(160, 120);
  TriangleMesh below = a_level_square({0.5, 0.0, 0.0}, 0.4, 4);
  for (auto& [a, b, c] : below.triangles) std::swap(b, c);
  draw_mesh(canvas, a_plain_view(), below, 1, vertex_color, {1});
  draw_mesh(canvas, a_plain_view(), a_level_square({0.5, 0.0, 2.0}, 0.4, 4), 1, vertex_color, {1});
  EXPECT_EQ(std::ranges::count(canvas.id.pixels(), 1), 0);
}

TEST(Rasteriser, DrawsAnImageOnTheMesh) {
  const TriangleMesh table = a_level_square({0.5, 0.0, 0.0}, 0.4, 1);
  // Red where y is negative, blue elsewhere; one texel lies beside the other.
  ColorImage image(2, 1);
  image(0, 0) = {200, 0, 0};
  image(1, 0) = {0, 0, 200};
  std::vector<Eigen::Vector2f> coordinates;
  for (const auto& vertex : table.vertices) {
    coordinates.emplace_back(vertex.y() < 0.0F ? 0.0F : 1.0F, 0.5F);
  }
  const MeshImage on_mesh{image, coordinates};
  Canvas canvas(160, 120);
  const View view = a_plain_view();
  draw_mesh(canvas, view, table, 1, vertex_color, {1}, &on_mesh);
  const auto drawn_at = [&](double y) {
    const Eigen::Vector2d at =
        view.camera.project(view.T_base_view.inverse() * Eigen::Vector3d(0.5, y, 0.0));
    return canvas.color(static_cast<int>(at.x() + 0.5), static_cast<int>(at.y() + 0.5));
  };
  EXPECT_EQ(drawn_at(-0.15), (Rgb8{200, 0, 0}));
  EXPECT_EQ(drawn_at(0.15), (Rgb8{0, 0, 200}));
  EXPECT_NEAR(drawn_at(0.0).r, 100, 4);  // bilinear between texels
  EXPECT_NEAR(drawn_at(0.0).b, 100, 4);
}

TEST(Preview, ShowsTheWholeTableAndEveryObject) {
  const Scene scene = a_box_on_a_table();
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  for (const Eigen::Vector3d& corner : scene.support_planes[0].outline_base) {
    const Eigen::Vector3d p_view = view.T_base_view.inverse() * corner;
    ASSERT_GT(p_view.z(), 0.0);
    EXPECT_TRUE(view.camera.contains(view.camera.project(p_view)));
  }
  EXPECT_GT(view.T_base_view.translation().z(), 0.3) << "seen from above";
}

TEST(Preview, IsUpright) {
  const View view = choose_view(a_box_on_a_table(), kPreviewWidth, kPreviewHeight);
  const Eigen::Vector3d right = view.T_base_view.rotation() * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d down = view.T_base_view.rotation() * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(right.z(), 0.0, 1e-12);
  EXPECT_LT(down.z(), 0.0);
}

TEST(Preview, IsOnTheCamerasSide) {
  Scene scene = a_box_on_a_table();
  scene.camera_trajectory = Trajectory({{{0}, looking_down_from({0.5, 3.0, 1.0})}});
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  EXPECT_GT(view.T_base_view.translation().y(), 0.5);
}

TEST(Preview, ShowsARoomFromTheCamerasPosition) {
  Scene scene = a_box_on_a_table();
  scene.objects.clear();
  scene.support_planes.clear();
  scene.camera_trajectory = Trajectory({{{0}, looking_down_from({-2.0, 0.0, 1.0})}});
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  const Eigen::Vector3d middle = view.T_base_view.inverse() * Eigen::Vector3d(0.5, 0.0, 0.0);
  EXPECT_TRUE(view.camera.contains(view.camera.project(middle)));
  EXPECT_LT(view.T_base_view.translation().x(), 0.0);
}

TEST(Preview, IsUprightWhereTheWorldFrameIsNot) {
  // Base is the first camera's frame: the floor is at y = 1, and up is -y.
  Scene scene;
  const Pose tilted(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitX())),
                    Eigen::Vector3d(0.0, 1.0, 2.0));
  scene.mesh_base = transformed(tilted, a_level_square({0.0, 0.0, 0.0}, 2.0, 20));
  scene.camera_trajectory = Trajectory({{{0}, Pose()}});
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  const Eigen::Vector3d right = view.T_base_view.rotation() * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d down = view.T_base_view.rotation() * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(right.y(), 0.0, 1e-12);
  EXPECT_GT(down.y(), 0.5);
}

TEST(Preview, IsUprightByTheFloorWhereTheWorldFrameIsTilted) {
  // The world is tilted by 50 degrees about x, and the camera looks over the floor.
  Scene scene;
  const Pose tilt(Eigen::Quaterniond(Eigen::AngleAxisd(0.87, Eigen::Vector3d::UnitX())),
                  Eigen::Vector3d::Zero());
  scene.mesh_base = transformed(tilt, a_level_square({0.0, 0.0, 0.0}, 2.0, 20));
  Eigen::Matrix3d axes;  // forward along y, 20 degrees down
  axes << 1.0, 0.0, 0.0, 0.0, -0.34, 0.94, 0.0, -0.94, -0.34;
  const Pose camera(Eigen::Quaterniond(axes).normalized(), Eigen::Vector3d(0.0, -2.0, 0.8));
  scene.camera_trajectory = Trajectory({{{0}, tilt * camera}});
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  const Eigen::Vector3d up = tilt.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = view.T_base_view.rotation() * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d down = view.T_base_view.rotation() * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(right.dot(up), 0.0, 1e-6);
  EXPECT_LT(down.dot(up), -0.5);
}

/// A shelf in front of 15 views, and a far scrap of the floor that one of them saw.
Scene a_shelf_and_a_scrap(const Eigen::Vector3d& scrap_middle) {
  Scene scene;
  const Pose upright(Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI_2, Eigen::Vector3d::UnitY())),
                     Eigen::Vector3d(1.5, 0.0, 1.0));
  scene.mesh_base = transformed(upright, a_level_square({0.0, 0.0, 0.0}, 1.0, 40));
  const TriangleMesh scrap = a_level_square(scrap_middle, 0.3, 8);
  const auto first = static_cast<std::uint32_t>(scene.mesh_base.vertices.size());
  scene.mesh_base.vertices.insert(scene.mesh_base.vertices.end(), scrap.vertices.begin(),
                                  scrap.vertices.end());
  for (const auto& [a, b, c] : scrap.triangles) {
    scene.mesh_base.triangles.push_back({first + a, first + b, first + c});
  }
  scene.mesh_base.normals.clear();
  scene.mesh_base.colors.clear();
  SupportPlane& plane = scene.support_planes.emplace_back();
  plane.outline_base = {{0.35, 2.85, 0.0}, {0.65, 2.85, 0.0}, {0.65, 3.15, 0.0}};
  Eigen::Matrix3d axes;  // forward along x
  axes << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  std::vector<TimedPose> poses;
  for (int i = 0; i < 15; ++i) {
    poses.push_back({Stamp{i}, Pose(Eigen::Quaterniond(axes), {0.0, 0.02 * (i - 7), 1.0})});
  }
  scene.camera_trajectory = Trajectory(poses);
  return scene;
}

TEST(Preview, FramesWhatTheCameraLookedAtAndNotScrapsOfAFloor) {
  const Scene scene = a_shelf_and_a_scrap({0.5, 3.0, 0.0});
  const View view = choose_view(scene, kPreviewWidth, kPreviewHeight);
  Eigen::AlignedBox2d shelf;
  for (const double y : {-0.5, 0.5}) {
    for (const double z : {0.5, 1.5}) {
      shelf.extend(view.camera.project(view.T_base_view.inverse() * Eigen::Vector3d(1.5, y, z)));
    }
  }
  EXPECT_TRUE(view.camera.contains(shelf.min()) && view.camera.contains(shelf.max()));
  EXPECT_GT(shelf.sizes().y(), 0.6 * kPreviewHeight);
}

/// The longest dark run of pixels along a row in the lower left quarter [px]: the scale bar.
int length_of_scale_bar(const ColorImage& picture) {
  int longest = 0;
  for (int y = picture.height() / 2; y < picture.height(); ++y) {
    int run = 0;
    for (int x = 0; x < picture.width() / 2; ++x) {
      const Rgb8& c = picture(x, y);
      run = c.r < 60 && c.g < 60 && c.b < 60 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

TEST(Preview, ItsScaleIsThatOfWhatIsSeenWhateverLiesFarAway) {
  const int near = length_of_scale_bar(render_preview(a_shelf_and_a_scrap({0.5, 3.0, 0.0}), {1}));
  EXPECT_GT(near, 40);
  EXPECT_NEAR(length_of_scale_bar(render_preview(a_shelf_and_a_scrap({0.5, 60.0, 0.0}), {1})), near,
              2);
}

TEST(Preview, ShowsTheTexture) {
  Scene scene = a_box_on_a_table();
  const auto green = [&] {
    return std::ranges::count_if(render_preview(scene, {1}).pixels(),
                                 [](const Rgb8& c) { return c.g > 150 && c.r < 80 && c.b < 80; });
  };
  EXPECT_EQ(green(), 0);
  ColorImage image(16, 16);
  std::ranges::fill(image.pixels(), Rgb8{10, 220, 10});
  scene.levels_of_detail_base = {scene.mesh_base};
  SceneTexture& texture = scene.texture.emplace();
  texture.jpeg = encode_color(image).value();
  texture.width = image.width();
  texture.height = image.height();
  texture.coordinates = {
      std::vector<Eigen::Vector2f>(scene.mesh_base.vertices.size(), Eigen::Vector2f(0.5F, 0.5F))};
  EXPECT_GT(green(), 20'000);
}

TEST(Preview, ShowsTheTextureOfAnObjectOutlinedInItsColour) {
  Scene scene = a_box_on_a_table();
  ColorImage image(16, 16);
  std::ranges::fill(image.pixels(), Rgb8{10, 220, 10});
  const TriangleMesh box = with_sharp_edges(scene.objects[0].model.mesh_object);
  scene.objects[0].texture =
      BodyTexture{.jpeg = encode_color(image).value(),
                  .mesh_object = box,
                  .coordinates = std::vector<Eigen::Vector2f>(box.vertices.size(), {0.5F, 0.5F}),
                  .width = 16,
                  .height = 16};
  const ColorImage picture = render_preview(scene, {1});
  const auto count = [&](auto is_it) { return std::ranges::count_if(picture.pixels(), is_it); };
  const Rgb8 color = object_color(0);
  EXPECT_GT(count([](const Rgb8& c) { return c.g > 150 && c.r < 80 && c.b < 80; }), 2000);
  EXPECT_GT(count([&](const Rgb8& c) { return c == color; }), 200);
}

TEST(Preview, ShowsTheArmWithoutHidingWhatIsBehindIt) {
  Scene scene = a_box_on_a_table();
  const ColorImage before = render_preview(scene, {1});
  scene.robot.emplace();
  scene.robot->links.push_back(
      {"link", a_box({0.1F, 0.1F, 0.6F}), Pose::from_translation({0.3, 0.0, 0.3})});
  const ColorImage after = render_preview(scene, {1});
  std::size_t changed = 0;
  for (std::size_t i = 0; i < after.pixels().size(); ++i) {
    changed += after.pixels()[i] == before.pixels()[i] ? 0U : 1U;
  }
  EXPECT_GT(changed, 10'000U);
}

TEST(Preview, DrawsAnObjectInItsColour) {
  const ColorImage picture = render_preview(a_box_on_a_table(), {1});
  EXPECT_EQ(picture.width(), kPreviewWidth);
  EXPECT_EQ(picture.height(), kPreviewHeight);
  // The colour of the first movable object: blue.
  const auto blue = std::ranges::count_if(
      picture.pixels(), [](const Rgb8& c) { return c.b > 100 && c.b > c.g + 40 && c.g > c.r; });
  EXPECT_GT(blue, 2000);
}

TEST(Preview, FillsTheTableWhereOnlyABodyHidIt) {
  Scene scene = a_box_on_a_table();
  const auto red = [&] {
    return std::ranges::count_if(render_preview(scene, {1}).pixels(),
                                 [](const Rgb8& c) { return c.r > 150 && c.g < 60 && c.b < 60; });
  };
  const auto before = red();
  scene.unseen_support_base = a_level_square({0.5, 0.0, 0.001}, 0.4, 4);
  std::ranges::fill(scene.unseen_support_base.colors, Rgb8{220, 10, 10});
  EXPECT_GT(red(), before + 2000);
}

TEST(Preview, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = a_box_on_a_table();
  const ColorImage once = render_preview(scene, {1});
  for (const int threads : {2, 4}) {
    EXPECT_TRUE(std::ranges::equal(render_preview(scene, {threads}).pixels(), once.pixels()));
  }
}

TEST(Preview, RendersAnEmptyScene) {
  const ColorImage picture = render_preview(Scene(), {1});
  EXPECT_EQ(picture.width(), kPreviewWidth);
  EXPECT_EQ(picture.height(), kPreviewHeight);
}

}  // namespace
}  // namespace pcavr
