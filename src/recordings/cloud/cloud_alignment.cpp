// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_estimation.h>
#include <pcl/registration/correspondence_rejection_sample_consensus.h>
#include <pcl/registration/gicp.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/recordings/cloud/silence_pcl.hpp"

namespace pcavr {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;

// Radii and distances in voxels.
constexpr double kMatchDistance = 5.0;  // of corresponding points, for the iterations
constexpr double kAgreeDistance = 1.0;  // of points that agree
constexpr double kNormalRadius = 3.0;
constexpr double kFeatureRadius = 8.0;
constexpr double kFeatureInlier = 2.0;
constexpr int kMaxIterations = 40;
constexpr int kFeatureIterations = 20'000;
/// Fewer matches of features are chance.
constexpr std::size_t kMinMatches = 10;
/// Fewer points have no stable normals.
constexpr std::size_t kMinPoints = 50;

PclCloud::Ptr to_pcl(const Points& points) {
  auto cloud = std::make_shared<PclCloud>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (!std::isnan(p.x())) cloud->push_back({p.x(), p.y(), p.z()});
  }
  return cloud;
}

Pose to_pose(const Eigen::Matrix4f& matrix) {
  const Eigen::Matrix4d m = matrix.cast<double>();
  return Pose(Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>())).normalized(),
              m.topRightCorner<3, 1>());
}

CloudAgreement agreement_in(const pcl::KdTreeFLANN<pcl::PointXYZ>& tree_a, const Points& points_b,
                            const Pose& T_a_b, double tolerance) {
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  pcl::Indices indices(1);
  std::vector<float> squares(1);
  std::size_t near = 0;
  std::size_t all = 0;
  double sum = 0.0;
  for (const Eigen::Vector3f& point : points_b) {
    if (std::isnan(point.x())) continue;
    ++all;
    const Eigen::Vector3f p = R * point + t;
    // Searches at most one point, the nearest: a search within a radius is much faster where there
    // is none.
    if (tree_a.radiusSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), tolerance, indices, squares, 1) ==
        0)
      continue;
    ++near;
    sum += static_cast<double>(squares[0]);
  }
  if (near == 0) return {};
  return {static_cast<double>(near) / static_cast<double>(all),
          std::sqrt(sum / static_cast<double>(near))};
}

/// A thinned cloud that others are aligned with.
struct Reference {
  Pose T_world_cloud;
  PclCloud::Ptr cloud;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  Features::Ptr features;  ///< computed when first used
};

struct Candidate {
  Pose T_reference_cloud;
  CloudAgreement agreement;
};

class SequenceAligner {
 public:
  explicit SequenceAligner(const AlignmentOptions& options) : options_(options) {}

  /// nullopt where the cloud overlaps no reference.
  std::optional<Pose> add(const Points& points) {
    const PclCloud::Ptr cloud = to_pcl(points);
    if (cloud->size() < kMinPoints) return std::nullopt;
    if (references_.empty()) {
      add_reference(cloud, Pose());
      return Pose();
    }
    std::size_t at = references_.size() - 1;
    const Pose guess = references_[at]->T_world_cloud.inverse() * T_world_last_;
    Candidate best = refine(*references_[at], cloud, points, guess);
    if (best.agreement.overlap < options_.reference_overlap) {
      at = try_features(cloud, points, best);
      if (best.agreement.overlap < options_.min_overlap) return std::nullopt;
    }
    const Pose T_world_cloud = references_[at]->T_world_cloud * best.T_reference_cloud;
    sum_ += best.agreement.rms * best.agreement.rms;
    ++aligned_;
    result.rms = std::sqrt(sum_ / aligned_);
    result.min_overlap = std::min(result.min_overlap, best.agreement.overlap);
    T_world_last_ = T_world_cloud;
    if (best.agreement.overlap < options_.reference_overlap) add_reference(cloud, T_world_cloud);
    result.references = references_.size();
    return T_world_cloud;
  }

  CloudAlignment result;

 private:
  void add_reference(const PclCloud::Ptr& cloud, const Pose& T_world_cloud) {
    references_.push_back(std::make_unique<Reference>());
    references_.back()->T_world_cloud = T_world_cloud;
    references_.back()->cloud = cloud;
    references_.back()->tree.setInputCloud(cloud);
    result.references = references_.size();
  }

  /// Replaces `best`, of the last reference cloud, by a better one from features; returns its
  /// reference. The others are tried only where the last one does not overlap.
  std::size_t try_features(const PclCloud::Ptr& cloud, const Points& points, Candidate& best) {
    const Features::Ptr features = features_of(cloud);
    std::size_t at = references_.size() - 1;
    bool is_by_features = false;
    for (std::size_t i = references_.size(); i-- > 0;) {
      const std::optional<Pose> matched = match_features(*references_[i], cloud, features);
      if (matched) {
        const Candidate other = refine(*references_[i], cloud, points, *matched);
        if (other.agreement.overlap > best.agreement.overlap) {
          best = other;
          at = i;
          is_by_features = true;
        }
      }
      if (best.agreement.overlap >= options_.min_overlap) break;
    }
    if (is_by_features) ++result.by_features;
    return at;
  }

  [[nodiscard]] Candidate refine(const Reference& reference, const PclCloud::Ptr& cloud,
                                 const Points& points, const Pose& guess) const {
    pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
    icp.setInputSource(cloud);
    icp.setInputTarget(reference.cloud);
    icp.setMaxCorrespondenceDistance(kMatchDistance * options_.voxel);
    icp.setMaximumIterations(kMaxIterations);
    icp.setTransformationEpsilon(1e-5);
    PclCloud aligned;
    icp.align(aligned, guess.matrix().cast<float>());
    Pose T_reference_cloud = guess;
    if (icp.hasConverged() && icp.getFinalTransformation().allFinite()) {
      T_reference_cloud = to_pose(icp.getFinalTransformation());
    }
    return {T_reference_cloud, agreement_in(reference.tree, points, T_reference_cloud,
                                            kAgreeDistance * options_.voxel)};
  }

  [[nodiscard]] Features::Ptr features_of(const PclCloud::Ptr& cloud) const {
    auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setRadiusSearch(kNormalRadius * options_.voxel);
    estimation.compute(*normals);
    auto features = std::make_shared<Features>();
    pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> fpfh;
    fpfh.setInputCloud(cloud);
    fpfh.setInputNormals(normals);
    fpfh.setRadiusSearch(kFeatureRadius * options_.voxel);
    fpfh.compute(*features);
    return features;
  }

  [[nodiscard]] std::optional<Pose> match_features(Reference& reference, const PclCloud::Ptr& cloud,
                                                   const Features::Ptr& features) const {
    if (!reference.features) reference.features = features_of(reference.cloud);
    pcl::registration::CorrespondenceEstimation<pcl::FPFHSignature33, pcl::FPFHSignature33>
        estimation;
    estimation.setInputSource(features);
    estimation.setInputTarget(reference.features);
    auto matches = std::make_shared<pcl::Correspondences>();
    estimation.determineReciprocalCorrespondences(*matches);
    if (matches->size() < kMinMatches) return std::nullopt;
    // Its random numbers have a fixed seed.
    pcl::registration::CorrespondenceRejectorSampleConsensus<pcl::PointXYZ> ransac;
    ransac.setInputSource(cloud);
    ransac.setInputTarget(reference.cloud);
    ransac.setInlierThreshold(kFeatureInlier * options_.voxel);
    ransac.setMaximumIterations(kFeatureIterations);
    ransac.setInputCorrespondences(matches);
    pcl::Correspondences inliers;
    ransac.getCorrespondences(inliers);
    if (inliers.size() < 3 || !ransac.getBestTransformation().allFinite()) return std::nullopt;
    return to_pose(ransac.getBestTransformation());
  }

  AlignmentOptions options_;
  std::vector<std::unique_ptr<Reference>> references_;
  Pose T_world_last_;
  double sum_ = 0.0;
  double aligned_ = 0.0;
};

}  // namespace

std::vector<Eigen::Vector3f> thinned(const Points& points, double voxel) {
  PCAVR_REQUIRE(voxel > 0.0, voxel);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(to_pcl(points));
  const auto edge = static_cast<float>(voxel);
  grid.setLeafSize(edge, edge, edge);
  PclCloud centroids;
  grid.filter(centroids);
  Points result;
  result.reserve(centroids.size());
  for (const pcl::PointXYZ& p : centroids) result.emplace_back(p.x, p.y, p.z);
  return result;
}

std::vector<CloudAgreement> compare_clouds(const Points& points_a, const Points& points_b,
                                           const std::vector<Pose>& T_a_b, double tolerance) {
  std::vector<CloudAgreement> agreements(T_a_b.size());
  const PclCloud::Ptr cloud_a = to_pcl(points_a);
  if (cloud_a->empty()) return agreements;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud_a);
  std::transform(T_a_b.begin(), T_a_b.end(), agreements.begin(),
                 [&](const Pose& pose) { return agreement_in(tree, points_b, pose, tolerance); });
  return agreements;
}

CloudAlignment align_clouds(const std::vector<Points>& clouds, const AlignmentOptions& options,
                            const Observer& observer) {
  PCAVR_REQUIRE(options.voxel > 0.0, options.voxel);
  const SilencePcl silence;
  SequenceAligner aligner(options);
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const std::optional<Pose> T_world_cloud = aligner.add(clouds[i]);
    if (!T_world_cloud) {
      aligner.result.failed = i;
      break;
    }
    aligner.result.T_world_cloud.push_back(*T_world_cloud);
    observer.on_progress("aligning", i + 1, clouds.size());
  }
  return std::move(aligner.result);
}

}  // namespace pcavr
