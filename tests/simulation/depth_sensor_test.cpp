// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/depth_sensor.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace pcavr::simulation {
namespace {

const CameraModel kCamera{
    .width = 320, .height = 240, .fx = 262.5, .fy = 262.5, .cx = 159.5, .cy = 119.5};
constexpr double kDegree = std::numbers::pi / 180.0;

/// The ideal image of a plane normal . p = offset (camera axes).
IdealFrame frame_of_plane(const Eigen::Vector3d& normal, double offset) {
  IdealFrame frame{
      .radiance = {},
      .depth = DepthImage(kCamera.width, kCamera.height),
      .normal_camera = Image<Eigen::Vector3f>(kCamera.width, kCamera.height, normal.cast<float>())};
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Eigen::Vector3d ray = kCamera.unproject(Eigen::Vector2d(x, y), 1.0);
      frame.depth(x, y) = static_cast<float>(offset / normal.dot(ray));
    }
  }
  return frame;
}

IdealFrame wall_at(double z) { return frame_of_plane(-Eigen::Vector3d::UnitZ(), -z); }

/// A sensor without dropouts and outliers.
DepthSensor noise_only() {
  DepthSensor sensor;
  sensor.loss_probability = 0.0;
  sensor.outlier_probability = 0.0;
  sensor.noise.min_depth = 0.4;
  sensor.noise.max_depth = 4.0;
  return sensor;
}

struct Moments {
  double mean = 0.0;
  double std = 0.0;
};

Moments moments(const DepthImage& measured, const DepthImage& truth) {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < truth.pixels().size(); ++i) {
    if (measured.pixels()[i] <= 0.0F) continue;
    const double error = measured.pixels()[i] - truth.pixels()[i];
    sum += error;
    squares += error * error;
    ++count;
  }
  return {sum / count, std::sqrt(squares / count - sum * sum / (count * count))};
}

double share_of(const DepthImage& depth, const std::function<bool(float)>& condition) {
  double count = 0.0;
  for (const float z : depth.pixels()) count += condition(z) ? 1.0 : 0.0;
  return count / static_cast<double>(depth.pixels().size());
}

TEST(DepthSensor, AxialNoiseHasTheModelsStdAtEveryRange) {
  DepthSensor sensor = noise_only();
  sensor.disparity_steps = 1e5;  // negligible rounding
  for (const double z : {0.6, 1.0, 2.0, 3.5}) {
    const IdealFrame frame = wall_at(z);
    const Moments error = moments(measure_depth(sensor, kCamera, frame, 7), frame.depth);
    // The incidence grows to 37 degrees over the image, which adds up to 0.1 mm; 76800 pixels with
    // correlated noise estimate the std to 2 %.
    EXPECT_NEAR(error.std, sensor.noise.depth_std(z), 0.02 * sensor.noise.depth_std(z) + 1e-4) << z;
    EXPECT_NEAR(error.mean, 0.0, 0.03 * sensor.noise.depth_std(z)) << z;
  }
}

TEST(DepthSensor, RoundsDisparityToSteps) {
  const DepthSensor sensor = noise_only();
  const DepthImage depth = measure_depth(sensor, kCamera, wall_at(2.5), 7);
  for (const float z : depth.pixels()) {
    const double steps = 580.0 * 0.075 / z * 8.0;
    // A float's depth of 2.5 m is rounded to 2e-7 m: 1e-5 steps.
    EXPECT_NEAR(steps, std::round(steps), 1e-4);
  }
}

TEST(DepthSensor, NoiseOfNeighboursIsCorrelated) {
  DepthSensor sensor = noise_only();
  sensor.disparity_steps = 1e5;
  const IdealFrame frame = wall_at(1.5);
  const DepthImage depth = measure_depth(sensor, kCamera, frame, 7);
  const auto correlation = [&](int apart) {
    double product = 0.0;
    double square = 0.0;
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x + apart < kCamera.width; ++x) {
        const double a = depth(x, y) - frame.depth(x, y);
        product += a * (depth(x + apart, y) - frame.depth(x + apart, y));
        square += a * a;
      }
    }
    return product / square;
  };
  // exp(-d^2 / (4 sigma^2)) for noise smoothed by a Gaussian; the kernel is sampled at whole
  // pixels.
  EXPECT_NEAR(correlation(1), std::exp(-1.0 / (4.0 * 0.75 * 0.75)), 0.03);
  EXPECT_NEAR(correlation(2), std::exp(-4.0 / (4.0 * 0.75 * 0.75)), 0.03);
  EXPECT_NEAR(correlation(6), 0.0, 0.03);
}

TEST(DepthSensor, LateralNoiseDoesNotChangeASlantedPlane) {
  DepthSensor sensor = noise_only();
  sensor.noise = DepthNoise(0.1, 10.0);
  sensor.noise.constant = 0.0;
  sensor.noise.quadratic = 0.0;
  sensor.noise.grazing = 0.0;
  sensor.disparity_steps = 1e6;
  const IdealFrame frame =
      frame_of_plane(Eigen::Vector3d(0.0, std::sin(0.9), -std::cos(0.9)), -0.8);
  const Moments error = moments(measure_depth(sensor, kCamera, frame, 7), frame.depth);
  EXPECT_LT(error.std, 1e-5);  // [m]; rounding
}

TEST(DepthSensor, LateralNoiseShiftsAnEdge) {
  DepthSensor sensor = noise_only();
  sensor.edge_loss_probability = 0.0;
  sensor.baseline = 1e-6;  // no shadow of the projector
  IdealFrame frame = wall_at(2.0);
  constexpr int kEdge = 160;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = kEdge; x < kCamera.width; ++x) frame.depth(x, y) = 1.0F;
  }
  sensor.disparity_steps = 1e9;
  const DepthImage depth = measure_depth(sensor, kCamera, frame, 7);
  const auto crossed = [&](int x) {
    int count = 0;
    for (int y = 0; y < kCamera.height; ++y) count += (depth(x, y) < 1.5F) != (x >= kEdge) ? 1 : 0;
    return static_cast<double>(count) / kCamera.height;
  };
  // Std 0.8 px at normal incidence: a shift beyond +-0.5 px (rounded to a pixel) occurs in 27 % of
  // the rows on either side; three pixels away (beyond 2.5 px) in 0.1 %. Rows are correlated.
  EXPECT_NEAR(crossed(kEdge), 0.27, 0.10);
  EXPECT_NEAR(crossed(kEdge - 1), 0.27, 0.10);
  EXPECT_LT(crossed(kEdge - 4), 0.01);
}

TEST(DepthSensor, LosesGrazingSurfacesAndWhatIsOutOfRange) {
  const DepthSensor sensor = noise_only();
  const auto is_invalid = [](float z) { return z == 0.0F; };
  const auto slanted = [&](double degrees) {
    const double a = degrees * kDegree;
    // A narrow view: the incidence hardly changes over it.
    CameraModel narrow = kCamera;
    narrow.fx = narrow.fy = 1e4;
    IdealFrame frame = wall_at(1.0);
    const Eigen::Vector3f normal(0.0F, static_cast<float>(std::sin(a)),
                                 static_cast<float>(-std::cos(a)));
    for (Eigen::Vector3f& n : frame.normal_camera.pixels()) n = normal;
    return share_of(measure_depth(sensor, narrow, frame, 7), is_invalid);
  };
  EXPECT_EQ(slanted(70.0), 0.0);
  EXPECT_EQ(slanted(80.0), 1.0);
  EXPECT_EQ(share_of(measure_depth(sensor, kCamera, wall_at(0.3), 7), is_invalid), 1.0);
  EXPECT_EQ(share_of(measure_depth(sensor, kCamera, wall_at(5.0), 7), is_invalid), 1.0);
  EXPECT_EQ(share_of(measure_depth(sensor, kCamera, wall_at(0.0), 7), is_invalid), 1.0);
}

TEST(DepthSensor, OutliersAndDropoutsHaveTheirProbability) {
  DepthSensor sensor = noise_only();
  sensor.outlier_probability = 0.01;
  sensor.loss_probability = 0.02;
  const DepthImage depth = measure_depth(sensor, kCamera, wall_at(1.0), 7);
  // 76800 pixels: a share of 1 % has a std of 0.04 %. An outlier is within 5 cm of the truth once
  // in 36.
  EXPECT_NEAR(share_of(depth, [](float z) { return z > 0.0F && std::abs(z - 1.0F) > 0.05F; }),
              0.01 * 35.0 / 36.0, 0.0015);
  EXPECT_NEAR(share_of(depth, [](float z) { return z == 0.0F; }), 0.02, 0.002);
}

TEST(DepthSensor, TheProjectorsShadowLiesRightOfANearObject) {
  DepthSensor sensor = noise_only();
  sensor.edge_loss_probability = 0.0;
  IdealFrame frame = wall_at(2.0);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 100; x < 140; ++x) frame.depth(x, y) = 1.0F;
  }
  const DepthImage depth = measure_depth(sensor, kCamera, frame, 7);
  double lost = 0.0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      if (depth(x, y) > 0.0F) continue;
      ++lost;
      EXPECT_TRUE(x > 134 && x < 156) << x;
    }
  }
  // Its width is f b (1/1 m - 1/2 m) = 9.8 px.
  EXPECT_NEAR(lost / kCamera.height, 262.5 * 0.075 * 0.5, 1.0);
}

}  // namespace
}  // namespace pcavr::simulation
