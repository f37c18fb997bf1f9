// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/unseen_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

#include "perception/texture/synthesise_grain.hpp"
#include "texture/painted_wall.hpp"

namespace pcavr {
namespace {

constexpr double kHole = 0.06;  ///< radius of the holes [m]

/// The wall of painted_wall.hpp as a table, with a hole at x = 0 and one at x = 0.2.
TriangleMesh a_table_with_holes() {
  TriangleMesh table = test::wall_mesh(120, 80, {100, 110, 120});
  std::erase_if(table.triangles, [&](const auto& triangle) {
    const Eigen::Vector3f& p = table.vertices[triangle[0]];
    return std::hypot(p.x(), p.y()) < kHole || std::hypot(p.x() - 0.2F, p.y()) < kHole;
  });
  return table;
}

SupportArea the_area() {
  return {.plane_base = {},
          .outline_base = {{-0.3, -0.2, 0.0}, {0.3, -0.2, 0.0}, {0.3, 0.2, 0.0}, {-0.3, 0.2, 0.0}}};
}

/// Views in which the hole at x = 0 is dynamic, and the other one was not measured.
std::vector<TextureView> the_views(bool is_seen_through) {
  std::vector<TextureView> views =
      test::take_views([](double, double) { return Eigen::Vector3d::Constant(100.0).eval(); });
  const CameraModel camera = test::wall_camera();
  for (TextureView& view : views) {
    view.is_dynamic = MaskImage(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d p =
            view.T_base_camera * camera.unproject({x, y}, static_cast<double>(view.depth(x, y)));
        if (std::hypot(p.x() - 0.2, p.y()) < kHole) view.depth(x, y) = 0.0F;
        if (std::hypot(p.x(), p.y()) < kHole + 0.01) view.is_dynamic(x, y) = 1;
      }
    }
  }
  if (is_seen_through) {
    views.back().is_dynamic = {};
    for (float& depth : views.back().depth.pixels()) depth += 0.2F;
  }
  return views;
}

TEST(UnseenSupport, FillsWhatOnlyDynamicPixelsHid) {
  const TriangleMesh found = find_unseen_support({the_area()}, a_table_with_holes(),
                                                 the_views(false), test::wall_camera(), 0.005);
  ASSERT_FALSE(found.triangles.empty());
  EXPECT_NEAR(surface_area(found), M_PI * kHole * kHole, 0.25 * M_PI * kHole * kHole);
  for (std::size_t i = 0; i < found.vertices.size(); ++i) {
    // The other hole is not filled: no dynamic pixel hid it.
    EXPECT_LT(found.vertices[i].head<2>().norm(), kHole + 0.02F);
    EXPECT_NEAR(found.vertices[i].z(), 0.0F, 0.002F);
    EXPECT_EQ(found.colors[i], (Rgb8{100, 110, 120}));
  }
}

// Stripes of 4 cm along y: the filled hole has them, in step with those around it.
TEST(UnseenSupport, ContinuesTheGrainOfThePlane) {
  const auto gray_at = [](float x) { return 110.0F + 40.0F * std::sin(50.0F * float(M_PI) * x); };
  TriangleMesh table = a_table_with_holes();
  for (std::size_t i = 0; i < table.vertices.size(); ++i) {
    const auto gray = static_cast<std::uint8_t>(gray_at(table.vertices[i].x()));
    table.colors[i] = {gray, gray, gray};
  }
  const TriangleMesh found =
      find_unseen_support({the_area()}, table, the_views(false), test::wall_camera(), 0.005);
  ASSERT_FALSE(found.triangles.empty());
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < found.vertices.size(); ++i) {
    const double truth = static_cast<double>(gray_at(found.vertices[i].x())) - 110.0;
    products += truth * (found.colors[i].g - 110.0);
    squares += truth * truth;
  }
  // The filled hole has at least this share of the stripes' contrast; smooth colours have none.
  EXPECT_GT(products / squares, 0.6);
}

/// Its grain changes from pixel to pixel by up to 12 of 255.
std::uint8_t gray_with_grain(int x, int y) {
  return static_cast<std::uint8_t>(110 + (x * 37 + y * 101 + x * y * 13) % 25 - 12);
}

TEST(ContinueGrain, DoesNotCopyAShadow) {
  constexpr int kWidth = 50;
  constexpr int kHeight = 30;
  ColorImage image(kWidth, kHeight);
  MaskImage is_known(kWidth, kHeight, 1);
  MaskImage is_gap(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // Wherever the gap's grain is copied from, the shadow is in it.
      const bool is_shadow = x >= 31 && x < 40 && y >= 10 && y < 19;
      const auto gray = static_cast<std::uint8_t>(gray_with_grain(x, y) - (is_shadow ? 45 : 0));
      image(x, y) = {gray, gray, gray};
      if (x < 4 || x >= 24 || y < 5 || y >= 25) continue;
      image(x, y) = {110, 110, 110};
      is_known(x, y) = 0;
      is_gap(x, y) = 1;
    }
  }
  synthesise_grain(image, is_known, is_gap);
  int lowest = 255;
  int highest = 0;
  for (int y = 5; y < 25; ++y) {
    for (int x = 4; x < 24; ++x) {
      lowest = std::min<int>(lowest, image(x, y).g);
      highest = std::max<int>(highest, image(x, y).g);
    }
  }
  EXPECT_GT(highest, 115);  // there is grain
  EXPECT_GT(lowest, 90);
}

// A green wall stands on the table beside the hole; the colours at its foot are mixed.
TEST(UnseenSupport, DoesNotContinueTheColourOfWhatStandsOnThePlane) {
  const float foot = static_cast<float>(kHole) + 0.004F;
  const Rgb8 green{20, 200, 30};
  TriangleMesh table = a_table_with_holes();
  for (std::size_t i = 0; i < table.vertices.size(); ++i) {
    const Eigen::Vector3f& p = table.vertices[i];
    if (std::abs(p.x() + foot) < 0.006F && std::abs(p.y()) < 0.02F) table.colors[i] = green;
  }
  const auto first = static_cast<std::uint32_t>(table.vertices.size());
  for (const float y : {-0.02F, 0.02F}) {
    for (const float z : {0.0F, 0.1F}) {
      table.vertices.emplace_back(-foot, y, z);
      table.normals.emplace_back(1.0F, 0.0F, 0.0F);
      table.colors.push_back(green);
    }
  }
  table.triangles.push_back({first, first + 1, first + 2});
  table.triangles.push_back({first + 1, first + 3, first + 2});
  const TriangleMesh found =
      find_unseen_support({the_area()}, table, the_views(false), test::wall_camera(), 0.005);
  ASSERT_FALSE(found.triangles.empty());
  for (const Rgb8& color : found.colors) EXPECT_LT(color.g, 120);
}

// The scan ends between two squares, on one side some millimetres beside what a body hid.
TEST(UnseenSupport, LeavesNoSeamBesideTheScan) {
  TriangleMesh table = a_table_with_holes();
  for (Eigen::Vector3f& v : table.vertices) v.x() += 0.0008F;
  std::vector<TextureView> views = the_views(false);
  for (TextureView& view : views) {
    for (int y = 0; y < view.depth.height(); ++y) {
      for (int x = 0; x < view.depth.width(); ++x) {
        const Eigen::Vector3d p =
            view.T_base_camera * test::wall_camera().unproject({x, y}, double(view.depth(x, y)));
        if (std::hypot(p.x(), p.y()) > kHole + 0.003) view.is_dynamic(x, y) = 0;
      }
    }
  }
  const TriangleMesh found =
      find_unseen_support({the_area()}, table, views, test::wall_camera(), 0.005);
  ASSERT_FALSE(found.triangles.empty());
  const SurfaceQuery scan(table);
  const SurfaceQuery filled(found);
  for (float x = -0.07F; x < 0.07F; x += 0.001F) {
    for (float y = -0.07F; y < 0.07F; y += 0.001F) {
      const Eigen::Vector3f above(x, y, 0.1F);
      EXPECT_TRUE(scan.cast(above, -Eigen::Vector3f::UnitZ()) ||
                  filled.cast(above, -Eigen::Vector3f::UnitZ()))
          << x << ", " << y;
    }
  }
}

TEST(UnseenSupport, DoesNotFillWhatAViewSawThrough) {
  EXPECT_TRUE(find_unseen_support({the_area()}, a_table_with_holes(), the_views(true),
                                  test::wall_camera(), 0.005)
                  .triangles.empty());
}

}  // namespace
}  // namespace pcavr
