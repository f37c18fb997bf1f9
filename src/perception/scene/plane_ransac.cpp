// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "plane_ransac.hpp"

#include <algorithm>
#include <cmath>

#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_perpendicular_plane.h>

#include "pcavr/recordings/cloud/silence_pcl.hpp"

namespace pcavr {
namespace {

/// RANSAC only gives the initial plane; a least-squares fit to all points follows.
constexpr std::size_t kMaxPoints = 20'000;
constexpr int kMaxIterations = 500;
/// Confidence of drawing a sample without outliers.
constexpr double kConfidence = 0.9999;

}  // namespace

std::optional<Plane> ransac_plane(const std::vector<Eigen::Vector3d>& points, double distance,
                                  double min_upward) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  const std::size_t stride = points.size() / kMaxPoints + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector3f p = points[i].cast<float>();
    cloud->emplace_back(p.x(), p.y(), p.z());
  }
  if (cloud->size() < 3) return std::nullopt;
  const auto model = pcl::make_shared<pcl::SampleConsensusModelPerpendicularPlane<pcl::PointXYZ>>(
      cloud, /*random=*/false);
  model->setAxis(Eigen::Vector3f::UnitZ());
  model->setEpsAngle(std::acos(min_upward));
  pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, distance);
  ransac.setMaxIterations(kMaxIterations);
  ransac.setProbability(kConfidence);
  const SilencePcl silence;
  if (!ransac.computeModel()) return std::nullopt;
  Eigen::VectorXf coefficients;
  ransac.getModelCoefficients(coefficients);
  const Eigen::Vector3d normal = coefficients.head<3>().cast<double>();
  const double norm = normal.z() < 0.0 ? -normal.norm() : normal.norm();
  return Plane{normal / norm, -static_cast<double>(coefficients[3]) / norm};
}

}  // namespace pcavr
