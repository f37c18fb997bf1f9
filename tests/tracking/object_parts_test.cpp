// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "perception/tracking/object_contour.hpp"
#include "perception/tracking/object_rest.hpp"
#include "tracking/object_scene.hpp"

namespace pcavr::tracking {
namespace {

using test::box_mesh;
using test::kBoxSize;
using test::on_the_table;
using test::scene_camera;
using test::scene_camera_pose;
using test::SceneRenderer;

// --- The average at rest ------------------------------------------------------------------------

constexpr double kTranslationStd = 3e-4;  // [m]
constexpr double kRotationStd = 1e-3;     // [rad]

PoseMeasurement noisy(const Pose& pose, Random& random) {
  Vector6d noise;
  for (int i = 0; i < 6; ++i) noise[i] = (i < 3 ? kTranslationStd : kRotationStd) * random.normal();
  Vector6d information;
  information << Eigen::Vector3d::Constant(1.0 / (kTranslationStd * kTranslationStd)),
      Eigen::Vector3d::Constant(1.0 / (kRotationStd * kRotationStd));
  return {pose * Pose::exp(noise), information.asDiagonal(), Matrix6d::Zero()};
}

TEST(RestFilter, ReducesTheCovarianceAtRest) {
  Random random(1);
  RestFilter filter;
  const Pose pose = on_the_table(0.1, 0.2, 0.3);
  RestFilter::Estimate estimate;
  for (int n = 0; n < 60; ++n) estimate = filter.add(noisy(pose, random));
  EXPECT_TRUE(estimate.is_at_rest);
  // The mean of 60: a std of 0.04 mm per axis; four standard deviations.
  EXPECT_LT(translation_distance(estimate.T_base_object, pose), 2.5e-4);
  EXPECT_LT(estimate.covariance(0, 0), 0.1 * kTranslationStd * kTranslationStd);
}

TEST(RestFilter, RarelyDetectsMotionInNoise) {
  Random random(2);
  RestFilter filter;
  int moving = 0;
  for (int n = 0; n < 2000; ++n) {
    if (!filter.add(noisy(Pose(), random)).is_at_rest && n > 10) ++moving;
  }
  EXPECT_LE(moving, 10);
}

TEST(RestFilter, ContinuesAfterOneOutlier) {
  Random random(3);
  RestFilter filter;
  for (int n = 0; n < 30; ++n) (void)filter.add(noisy(Pose(), random));
  EXPECT_FALSE(filter.add(noisy(Pose::from_translation({0.01, 0, 0}), random)).is_at_rest);
  const RestFilter::Estimate after = filter.add(noisy(Pose(), random));
  EXPECT_TRUE(after.is_at_rest);
  EXPECT_LT(after.T_base_object.translation().norm(), 3e-4);
}

TEST(RestFilter, DetectsAStepImmediately) {
  Random random(4);
  RestFilter filter;
  for (int n = 0; n < 30; ++n) (void)filter.add(noisy(Pose(), random));
  const Pose stepped = Pose::from_translation({0, 0.003, 0});
  for (int n = 0; n < 4; ++n) {
    const RestFilter::Estimate estimate = filter.add(noisy(stepped, random));
    EXPECT_FALSE(estimate.is_at_rest);
    EXPECT_LT(translation_distance(estimate.T_base_object, stepped), 5.0 * kTranslationStd);
  }
}

TEST(RestFilter, DetectsSlowSliding) {
  Random random(5);
  RestFilter filter;
  double max_error = 0.0;
  for (int n = 0; n < 300; ++n) {
    const Pose pose = Pose::from_translation({0.001 * n / 30.0, 0, 0});  // 1 mm/s
    const RestFilter::Estimate estimate = filter.add(noisy(pose, random));
    max_error = std::max(max_error, translation_distance(estimate.T_base_object, pose));
  }
  EXPECT_LT(max_error, 5.0 * kTranslationStd);
}

TEST(RestFilter, DoesNotDetectMotionFromAnUncertainCamera) {
  Random random(6);
  RestFilter filter;
  int moving = 0;
  for (int n = 0; n < 90; ++n) {
    // The camera's pose drifts by 1 mm back and forth.
    PoseMeasurement measurement =
        noisy(Pose::from_translation({0.001 * std::sin(0.2 * n), 0, 0}), random);
    measurement.camera_covariance.topLeftCorner<3, 3>() = 1e-6 * Eigen::Matrix3d::Identity();
    if (!filter.add(measurement).is_at_rest && n > 10) ++moving;
  }
  EXPECT_EQ(moving, 0);
}

// --- The contour --------------------------------------------------------------------------------

// The box stands 3 mm to the side of its predicted pose; the contour matches measure that, on both
// sides.
TEST(MatchContour, MeasuresTheOffsetFromThePrediction) {
  SceneRenderer renderer(7);
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  const SurfaceQuery surface(box_mesh(kBoxSize));
  const DepthImage depth =
      renderer.frame(0, {transformed(T_base_box, box_mesh(kBoxSize))}).frame.depth;
  const Eigen::Vector3d lateral =
      0.003 * (scene_camera_pose().rotation() * Eigen::Vector3d::UnitX());
  for (const double side : {-1.0, 0.0, 1.0}) {
    const Pose expected = Pose::from_translation(side * lateral) * T_base_box;
    const auto matches = match_contour(surface, scene_camera(), depth, DepthNoise{},
                                       scene_camera_pose().inverse() * expected);
    ASSERT_GE(matches.size(), 15U);
    double pixels = 0.0;
    double weight = 0.0;
    for (const ContourMatch& match : matches) {
      pixels += match.outward_pixels * match.normal.x();
      weight += match.normal.x() * match.normal.x();
    }
    // 3 mm at 0.8 m are 1.45 px; a pixel's rounding averages to some 0.1.
    EXPECT_NEAR(pixels / weight, -side * 1.45, 0.4) << side;
  }
}

TEST(MatchContour, FindsNoMatchWhereTheSurfaceContinues) {
  SceneRenderer renderer(8);
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  const SurfaceQuery surface(box_mesh(kBoxSize));
  const DepthImage depth =
      renderer.frame(0, {transformed(T_base_box, box_mesh(kBoxSize))}).frame.depth;
  for (const ContourMatch& match : match_contour(surface, scene_camera(), depth, DepthNoise{},
                                                 scene_camera_pose().inverse() * T_base_box)) {
    // The lower edges, where the box stands on the table.
    const bool is_foot = match.p_object.z() < -0.04 && match.normal.y() > 0.9;
    EXPECT_FALSE(is_foot) << match.p_object.transpose();
  }
}

// --- The mask -----------------------------------------------------------------------------------

int marked(const MaskImage& mask) {
  return static_cast<int>(std::count_if(mask.pixels().begin(), mask.pixels().end(),
                                        [](std::uint8_t pixel) { return pixel != 0; }));
}

class BoxMask : public ::testing::Test {
 protected:
  const CameraModel camera_ = scene_camera();
  const SurfaceQuery surface_{box_mesh(kBoxSize)};
  const Pose T_camera_box_ = scene_camera_pose().inverse() * on_the_table(0, 0, 0.2);
  const DepthImage body_ = render_depth(surface_, camera_, T_camera_box_.inverse());

  [[nodiscard]] MaskImage mask(const DepthImage& depth, int margin) const {
    MaskImage mask(camera_.width, camera_.height, 0);
    mask_body(surface_, T_camera_box_, camera_, depth, DepthNoise{}, margin, mask);
    return mask;
  }
};

TEST_F(BoxMask, ContainsEveryPixelOfTheBody) {
  const MaskImage exact = mask(body_, 0);
  int body = 0;
  for (int y = 0; y < camera_.height; ++y) {
    for (int x = 0; x < camera_.width; ++x) {
      if (body_(x, y) == 0.0F) continue;
      ++body;
      EXPECT_NE(exact(x, y), 0) << x << ' ' << y;
    }
  }
  EXPECT_GT(body, 3000);
  // Two pixels more on each side: twice the outline of some 250 pixels.
  EXPECT_LT(marked(exact), body + 600);
}

TEST_F(BoxMask, GrowsWithTheMargin) {
  const MaskImage narrow = mask(body_, 0);
  const MaskImage wide = mask(body_, 5);
  for (std::size_t i = 0; i < narrow.pixels().size(); ++i) {
    if (narrow.pixels()[i] != 0) {
      EXPECT_NE(wide.pixels()[i], 0);
    }
  }
  EXPECT_GT(marked(wide), marked(narrow) + 5 * 200);
}

TEST_F(BoxMask, ExcludesOccluders) {
  DepthImage covered = body_;
  for (float& z : covered.pixels()) {
    if (z > 0.0F) z -= 0.05F;
  }
  const MaskImage mask = this->mask(covered, 0);
  int body = 0;
  int masked = 0;
  for (int y = 0; y < camera_.height; ++y) {
    for (int x = 0; x < camera_.width; ++x) {
      if (covered(x, y) == 0.0F) continue;
      ++body;
      if (mask(x, y) != 0) ++masked;
    }
  }
  // Near an edge, the dilated depth of a face at grazing incidence is nearer by more than 5 cm.
  EXPECT_LT(masked, body / 50);
}

TEST_F(BoxMask, IncludesDepthBehindTheBodyAndPixelsWithoutDepth) {
  DepthImage far(camera_.width, camera_.height, 3.0F);
  const DepthImage nothing(camera_.width, camera_.height, 0.0F);
  EXPECT_EQ(marked(mask(far, 2)), marked(mask(body_, 2)));
  EXPECT_EQ(marked(mask(nothing, 2)), marked(mask(body_, 2)));
}

TEST_F(BoxMask, KeepsPixelsAlreadySet) {
  MaskImage mask(camera_.width, camera_.height, 0);
  mask(0, 0) = 7;
  mask_body(surface_, T_camera_box_, camera_, body_, DepthNoise{}, 0, mask);
  EXPECT_EQ(mask(0, 0), 7);
}

TEST_F(BoxMask, IsEmptyForABodyBehindTheCamera) {
  MaskImage mask(camera_.width, camera_.height, 0);
  mask_body(surface_, Pose::from_translation({0, 0, -1}), camera_, body_, DepthNoise{}, 3, mask);
  EXPECT_EQ(marked(mask), 0);
}

TEST_F(BoxMask, RejectsAMaskOfAnotherSize) {
  MaskImage mask(7, 7, 0);
  EXPECT_THROW(mask_body(surface_, T_camera_box_, camera_, body_, DepthNoise{}, 0, mask),
               ContractError);
}

}  // namespace
}  // namespace pcavr::tracking
