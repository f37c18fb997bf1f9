// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Surfaces whose corners were rounded differently from triangle to triangle.
#include "base/model/close_vertices.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/model/cad_model.hpp"

#include "base/model/mesh_repair.hpp"
#include "support/meshes.hpp"

namespace pcavr::model {
namespace {

using test::box_mesh;
using test::sphere_mesh;

/// Each triangle with corners of its own, as in an STL, changed by `change`.
template <typename Change>
TriangleMesh separate_corners(const TriangleMesh& mesh, const Change& change) {
  TriangleMesh soup;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : triangle) soup.vertices.push_back(change(mesh.vertices[v]));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// Each coordinate up or down by a last bit, or not.
Eigen::Vector3f with_other_last_bits(Eigen::Vector3f p, Random& random) {
  for (float& x : p) {
    const std::size_t way = random.below(3);
    if (way > 0) x = std::nextafter(x, way == 1 ? 1e9F : -1e9F);
  }
  return p;
}

TEST(CloseVertices, CornersThatDifferInTheirLastBitAreOne) {
  Random random(3);
  for (const float away : {0.0F, 1.0F, 30.0F}) {
    TriangleMesh ball = sphere_mesh(0.1F, 20);
    for (Eigen::Vector3f& p : ball.vertices) p += Eigen::Vector3f(away, -away, 0.0F);
    const TriangleMesh soup = separate_corners(
        ball, [&](const Eigen::Vector3f& p) { return with_other_last_bits(p, random); });
    const auto cad = make_cad_model(soup, "ball", "ball.stl");
    ASSERT_TRUE(cad) << away << ' ' << cad.error().to_string();
    EXPECT_EQ(cad->mesh_object.vertices.size(), ball.vertices.size()) << away;
    EXPECT_NEAR(cad->volume, mass_properties(ball).volume, 3e-5 * (1.0 + away) * cad->volume);
  }
}

TEST(CloseVertices, ZeroAndTheRestOfASubtractionAreOne) {
  Random random(4);
  TriangleMesh box = box_mesh({0.1F, 0.2F, 0.3F});
  for (Eigen::Vector3f& p : box.vertices) p += Eigen::Vector3f(0.05F, 0.1F, 0.15F);
  const auto cad =
      make_cad_model(separate_corners(box,
                                      [&](Eigen::Vector3f p) {
                                        for (float& x : p) {
                                          if (x == 0.0F)
                                            x = 6e-17F * static_cast<float>(random.normal());
                                        }
                                        return p;
                                      }),
                     "box", "box.stl");
  ASSERT_TRUE(cad) << cad.error().to_string();
  EXPECT_EQ(cad->mesh_object.vertices.size(), 8U);
  EXPECT_NEAR(cad->volume, 0.006, 1e-9);
}

TEST(CloseVertices, TextOfSixDigitsIsClosed) {
  Random random(5);
  const TriangleMesh ball = sphere_mesh(0.1F, 12);
  const auto cad = make_cad_model(
      separate_corners(ball,
                       [&](const Eigen::Vector3f& p) {
                         // The sixth digit, up or down.
                         const Eigen::Vector3f q(1e-7F * static_cast<float>(random.below(2)), 0.0F,
                                                 0.0F);
                         return Eigen::Vector3f(p + q);
                       }),
      "ball", "ball.stl");
  ASSERT_TRUE(cad) << cad.error().to_string();
  EXPECT_EQ(cad->mesh_object.vertices.size(), ball.vertices.size());
}

TEST(CloseVertices, ThinBodiesStay) {
  Random random(6);
  // 100 and 10 times as thick as the largest last bit.
  for (const float thickness : {1e-6F, 1e-7F}) {
    TriangleMesh plate = box_mesh({0.1F, 0.1F, thickness});
    const TriangleMesh sound = with_closed_seams(weld_vertices(plate));
    EXPECT_EQ(sound.vertices, weld_vertices(plate).vertices);
    const TriangleMesh closed =
        with_closed_seams(weld_vertices(separate_corners(plate, [&](Eigen::Vector3f p) {
          p.x() = std::nextafter(p.x(), random.below(2) == 0 ? 1.0F : -1.0F);
          return p;
        })));
    EXPECT_EQ(find_open_edges(closed).count, 0U);
    EXPECT_EQ(closed.vertices.size(), 8U);
    EXPECT_NEAR(mass_properties(closed).volume, 0.01 * static_cast<double>(thickness),
                1e-5 * 0.01 * static_cast<double>(thickness));
  }
}

TEST(CloseVertices, HolesStayOpen) {
  TriangleMesh box = box_mesh({0.1F, 0.1F, 0.1F});
  box.triangles.pop_back();
  EXPECT_EQ(find_open_edges(with_closed_seams(box)).count, 3U);
  // A gap of 0.01 mm is no rounding.
  TriangleMesh gap =
      separate_corners(box_mesh({0.1F, 0.1F, 0.1F}), [](const Eigen::Vector3f& p) { return p; });
  gap.vertices[0].x() += 1e-5F;
  EXPECT_GT(find_open_edges(with_closed_seams(weld_vertices(gap))).count, 0U);
}

}  // namespace
}  // namespace pcavr::model
