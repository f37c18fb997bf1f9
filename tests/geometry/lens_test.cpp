// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/lens.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/camera.hpp"

namespace pcavr {
namespace {

constexpr LensModel kModels[] = {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye};

/// An Azure Kinect's depth camera, as published by its ROS driver: the denominator nearly cancels
/// the numerator.
const std::array<double, 8> kAzureKinect = {0.5285, -2.68,  0.0005, -0.0002,
                                            1.51,   0.4095, -2.50,  1.44};
const std::array<double, 4> kFisheye = {-0.0117, 0.0301, -0.0274, 0.0079};

/// Coefficients of the magnitude of real calibrations.
LensDistortion random_lens(LensModel model, Random& random) {
  std::vector<double> k;
  if (model == LensModel::fisheye) {
    for (const double bound : {0.1, 0.05, 0.03, 0.01}) k.push_back(random.uniform(-bound, bound));
  } else {
    for (const double bound : {0.4, 0.3, 0.005, 0.005, 0.2})
      k.push_back(random.uniform(-bound, bound));
  }
  if (model == LensModel::rational) {
    for (const double bound : {0.4, 0.3, 0.2}) k.push_back(random.uniform(-bound, bound));
  }
  return {model, k};
}

CameraModel camera_with(const LensDistortion& distortion) {
  return {.width = 640,
          .height = 480,
          .fx = 525.0,
          .fy = 520.0,
          .cx = 310.5,
          .cy = 245.5,
          .distortion = distortion};
}

TEST(LensDistortion, RoundTripsOverTheWholeImageForRandomLenses) {
  for (const LensModel model : kModels) {
    Random random(3);
    int lenses = 0;
    for (int trial = 0; trial < 200; ++trial) {
      CameraModel camera = camera_with(random_lens(model, random));
      if (model == LensModel::fisheye) camera.fx = camera.fy = random.uniform(300.0, 600.0);
      if (find_fold(camera)) continue;
      ++lenses;
      for (int i = 0; i < 100; ++i) {
        const Eigen::Vector2d pixel(random.uniform(-0.5, 639.5), random.uniform(-0.5, 479.5));
        const Eigen::Vector2d ray = camera.normalise(pixel);
        EXPECT_LE(ray.norm(), camera.distortion.max_radius());
        EXPECT_LT((camera.project(ray.homogeneous()) - pixel).norm(), 1e-8) << "lens " << trial;
      }
    }
    EXPECT_GT(lenses, 100);
  }
}

TEST(LensDistortion, UndistortInvertsDistortFarOutsideTheImage) {
  for (const LensModel model : kModels) {
    Random random(4);
    for (int trial = 0; trial < 100; ++trial) {
      const LensDistortion lens = random_lens(model, random);
      for (int i = 0; i < 50; ++i) {
        const double angle = random.uniform(0.0, 6.3);
        const double radius = std::exp(random.uniform(-8.0, 5.0));
        const Eigen::Vector2d p = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const Eigen::Vector2d q = lens.distort(p);
        EXPECT_LT((lens.distort(lens.undistort(q)) - q).norm(), 1e-10 * (1.0 + q.norm()))
            << "lens " << trial << ", radius " << radius;
      }
    }
  }
}

TEST(LensDistortion, NothingOutsideTheFieldOfViewProjectsIntoTheImage) {
  // Folds at 0.72 focal lengths, at the image's corners; from 1.16 on, the unextrapolated model
  // would project back to the image centre.
  const CameraModel camera = camera_with({-0.25, -0.35, 0.0, 0.0, 0.0});
  ASSERT_TRUE(camera.distortion.folds());
  for (double radius = camera.distortion.max_radius(); radius < 20.0; radius += 0.01) {
    for (double angle = 0.0; angle < 6.28; angle += 0.1) {
      const Eigen::Vector2d pixel =
          camera.project(Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 1.0));
      const double from_centre = (pixel - Eigen::Vector2d(310.5, 245.5)).norm();
      EXPECT_GE(
          from_centre,
          520.0 * camera.distortion.distort({camera.distortion.max_radius(), 0.0}).norm() - 1e-6);
    }
  }
}

TEST(LensDistortion, JacobianIsTheDerivativeOfDistort) {
  for (const LensModel model : kModels) {
    Random random(5);
    for (int trial = 0; trial < 200; ++trial) {
      const LensDistortion lens = random_lens(model, random);
      // Points are inside and beyond max_radius(), but not across it, where the derivative jumps.
      const Eigen::Vector2d p(random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0));
      if (std::abs(p.norm() - lens.max_radius()) < 1e-3) continue;
      Eigen::Matrix2d jacobian;
      (void)lens.distort(p, &jacobian);
      EXPECT_GT(jacobian.determinant(), 0.0);
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = 1e-6 * Eigen::Vector2d::Unit(axis);
        const Eigen::Vector2d difference = (lens.distort(p + step) - lens.distort(p - step)) / 2e-6;
        EXPECT_LT((jacobian.col(axis) - difference).norm(), 1e-6 * (1.0 + jacobian.norm()));
      }
    }
  }
}

TEST(LensDistortion, AgreesWithOpenCv) {
  Random random(6);
  for (int trial = 0; trial < 30; ++trial) {
    for (const LensModel model : kModels) {
      const LensDistortion lens = trial == 0 && model == LensModel::rational
                                      ? LensDistortion(model, kAzureKinect)
                                      : random_lens(model, random);
      const CameraModel camera = camera_with(lens);
      std::vector<cv::Point3d> points;
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector2d ray =
            camera.normalise({random.uniform(-0.5, 639.5), random.uniform(-0.5, 479.5)});
        if (ray.norm() > lens.max_radius()) continue;
        const double z = random.uniform(0.3, 4.0);
        points.emplace_back(z * ray.x(), z * ray.y(), z);
      }
      if (points.empty()) continue;
      const cv::Mat matrix =
          (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
      const std::vector<double> k(lens.coefficients().begin(), lens.coefficients().end());
      const cv::Mat zero = cv::Mat::zeros(3, 1, CV_64F);
      std::vector<cv::Point2d> pixels;
      if (model == LensModel::fisheye) {
        cv::fisheye::projectPoints(points, pixels, zero, zero, matrix, k);
      } else {
        cv::projectPoints(points, zero, zero, matrix, k, pixels);
      }
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d pixel = camera.project({points[i].x, points[i].y, points[i].z});
        EXPECT_LT((pixel - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-9);
      }
    }
  }
}

TEST(LensDistortion, FisheyeIsExactNearTheAxis) {
  const LensDistortion lens(LensModel::fisheye, kFisheye);
  for (const double r : {0.0, 1e-12, 1e-6, 0.9e-4, 1.1e-4, 1e-3}) {
    const Eigen::Vector2d p(r, 0.0);
    const double angle = std::atan(r);
    EXPECT_NEAR(lens.distort(p).x(), angle * (1.0 + kFisheye[0] * angle * angle), 1e-15);
    EXPECT_NEAR(lens.undistort(lens.distort(p)).x(), r, 1e-15);
  }
}

TEST(LensDistortion, RationalWithoutADenominatorIsAPlumbBob) {
  const std::array<double, 8> k = {-0.28, 0.07, 0.0002, -0.0005, -0.005, 0.0, 0.0, 0.0};
  const LensDistortion rational(LensModel::rational, k);
  const LensDistortion plumb_bob(k[0], k[1], k[2], k[3], k[4]);
  EXPECT_EQ(rational.distort({0.4, -0.3}), plumb_bob.distort({0.4, -0.3}));
  EXPECT_EQ(rational.max_radius(), plumb_bob.max_radius());
  EXPECT_NE(rational, plumb_bob);
}

TEST(LensDistortion, ZeroCoefficientsAreNoDistortionExceptForAFisheye) {
  const std::array<double, 8> zeros{};
  EXPECT_TRUE(LensDistortion(0, 0, 0, 0, 0).is_none());
  EXPECT_TRUE(LensDistortion(LensModel::rational, zeros).is_none());
  const LensDistortion fisheye(LensModel::fisheye, std::span(zeros).first(4));
  EXPECT_FALSE(fisheye.is_none());
  EXPECT_NEAR(fisheye.distort({1.0, 0.0}).x(), std::atan(1.0), 1e-15);
}

TEST(LensDistortion, RejectsAWrongNumberOfCoefficients) {
  EXPECT_THROW(LensDistortion(LensModel::rational, kFisheye), ContractError);
}

}  // namespace
}  // namespace pcavr
