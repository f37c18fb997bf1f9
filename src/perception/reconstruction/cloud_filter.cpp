// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/cloud_filter.hpp"

#include <cstddef>
#include <memory>

#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

PointCloud remove_outliers(const PointCloud& cloud, const OutlierOptions& options) {
  PCAVR_REQUIRE(options.neighbours >= 1, options.neighbours);
  if (cloud.points.size() <= static_cast<std::size_t>(options.neighbours)) return cloud;

  auto points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  points->reserve(cloud.points.size());
  for (const Eigen::Vector3f& p : cloud.points) points->push_back({p.x(), p.y(), p.z()});
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(points);
  filter.setMeanK(options.neighbours);
  filter.setStddevMulThresh(options.std_multiplier);
  pcl::Indices inliers;
  filter.filter(inliers);

  PointCloud result;
  for (const pcl::index_t signed_index : inliers) {
    const auto index = static_cast<std::size_t>(signed_index);
    result.points.push_back(cloud.points[index]);
    if (!cloud.normals.empty()) result.normals.push_back(cloud.normals[index]);
    if (!cloud.colors.empty()) result.colors.push_back(cloud.colors[index]);
  }
  return result;
}

}  // namespace pcavr
