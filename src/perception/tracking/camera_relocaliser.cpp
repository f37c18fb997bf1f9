// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_relocaliser.hpp"

#include <algorithm>
#include <optional>

#include <Eigen/Geometry>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pcavr/base/core/random.hpp"

namespace pcavr::tracking {
namespace {

constexpr int kFeatures = 400;            // many times kMinMatchInliers
constexpr int kMinContrast = 7;           // [grey levels], above the noise of a sensor
constexpr std::size_t kCandidates = 6;    // keyframes matched by features
constexpr int kMinMatchInliers = 8;       // random matches give up to six
constexpr double kInlierDistance = 0.03;  // [m]; the alignment that follows is finer
constexpr int kRansacIterations = 200;    // 80 % success with 20 % inliers, samples of 3
const cv::Size kThumbnail(40, 30);

struct Features {
  cv::Mat descriptors;
  std::vector<Eigen::Vector3d> points;  ///< in the depth camera [m]
};

/// Corners of little contrast as well: the strongest are chosen, and a bare table has few.
cv::Ptr<cv::ORB> make_orb() {
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(kFeatures);
  orb->setFastThreshold(kMinContrast);
  return orb;
}

/// The pixels with a depth: features elsewhere would take the place of useful ones.
cv::Mat pixels_with_depth(const CellGrid& grid, const cv::Size& size,
                          const InverseDepth& inverse_depth) {
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  for (std::size_t cell = 0; cell < inverse_depth.size(); ++cell) {
    if (inverse_depth[cell] <= 0.0F) continue;
    const int x = static_cast<int>(cell) % grid.width() * grid.pixels;
    const int y = static_cast<int>(cell) / grid.width() * grid.pixels;
    mask(cv::Rect(x, y, grid.pixels, grid.pixels)).setTo(255);
  }
  return mask;
}

/// ORB features with a 3D point.
Features detect_features(const Sensor& sensor, const cv::Mat& gray,
                         const InverseDepth& inverse_depth) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  make_orb()->detectAndCompute(gray, pixels_with_depth(sensor.grid, gray.size(), inverse_depth),
                               keypoints, descriptors);
  Features features;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::Point2f pixel = keypoints[i].pt;
    const int x = static_cast<int>(pixel.x) / sensor.grid.pixels;
    const int y = static_cast<int>(pixel.y) / sensor.grid.pixels;
    if (x >= sensor.grid.width() || y >= sensor.grid.height()) continue;
    const float w = inverse_depth[static_cast<std::size_t>(y * sensor.grid.width() + x)];
    if (w <= 0.0F) continue;
    features.points.push_back(sensor.camera.unproject({pixel.x, pixel.y}, 1.0 / double{w}));
    features.descriptors.push_back(descriptors.row(static_cast<int>(i)));
  }
  return features;
}

/// Small image normalised in brightness and contrast, for place recognition: nearby views have
/// similar thumbnails [Klein & Murray 2008].
cv::Mat thumbnail(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, kThumbnail, 0.0, 0.0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::Scalar mean;
  cv::Scalar std_dev;
  cv::meanStdDev(small, mean, std_dev);
  small = (small - mean[0]) / std::max(1.0, std_dev[0]);
  return small;
}

/// The keyframes whose thumbnails are most similar to the frame's, best first.
std::vector<std::size_t> similar_keyframes(const std::vector<Keyframe>& keyframes,
                                           const cv::Mat& gray, int excluded_segment) {
  const cv::Mat query = thumbnail(gray);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    if (keyframes[k].segment == excluded_segment) continue;
    ranked.emplace_back(cv::norm(query, thumbnail(keyframes[k].gray), cv::NORM_L2), k);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> best;
  for (const auto& [difference, k] : ranked) {
    if (best.size() < kCandidates) best.push_back(k);
  }
  return best;
}

/// Least-squares rigid transform of point pairs (to, from) [Umeyama 1991].
Pose fit_pose(const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& pairs) {
  Eigen::Matrix3Xd to(3, static_cast<Eigen::Index>(pairs.size()));
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    to.col(static_cast<Eigen::Index>(i)) = pairs[i].first;
    from.col(static_cast<Eigen::Index>(i)) = pairs[i].second;
  }
  return Pose::from_matrix(Eigen::umeyama(from, to, false));
}

/// RANSAC [Fischler & Bolles 1981] over pairs of points; nothing if there are too few inliers.
std::optional<Pose> estimate_pose_ransac(
    const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& pairs) {
  if (pairs.size() < kMinMatchInliers) return std::nullopt;
  const auto inliers_of = [&](const Pose& pose) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> inliers;
    for (const auto& pair : pairs) {
      if ((pose * pair.second - pair.first).norm() < kInlierDistance) inliers.push_back(pair);
    }
    return inliers;
  };
  Random random(pairs.size());
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> best;
  for (int iteration = 0; iteration < kRansacIterations; ++iteration) {
    const auto& a = pairs[random.below(pairs.size())];
    const auto& b = pairs[random.below(pairs.size())];
    const auto& c = pairs[random.below(pairs.size())];
    const double area = (b.second - a.second).cross(c.second - a.second).norm();
    if (area < 1e-3) continue;  // [m^2]; degenerate: nearly collinear, or one point twice
    auto inliers = inliers_of(fit_pose({a, b, c}));
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  if (best.size() < kMinMatchInliers) return std::nullopt;
  return fit_pose(inliers_of(fit_pose(best)));
}

/// The pose of the features in a keyframe; nothing if too few agree.
std::optional<Pose> pose_in(const Sensor& sensor, const Keyframe& keyframe, const Features& frame) {
  if (frame.points.size() < kMinMatchInliers) return std::nullopt;
  const Features model = detect_features(sensor, keyframe.gray, keyframe.model.inverse_depth);
  if (model.points.size() < kMinMatchInliers) return std::nullopt;
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(frame.descriptors, model.descriptors, matches);
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
  pairs.reserve(matches.size());
  for (const cv::DMatch& match : matches) {
    pairs.emplace_back(model.points[static_cast<std::size_t>(match.trainIdx)],
                       frame.points[static_cast<std::size_t>(match.queryIdx)]);
  }
  return estimate_pose_ransac(pairs);
}

}  // namespace

std::optional<Pose> pose_by_features(const Sensor& sensor, const Keyframe& keyframe,
                                     const FrameView& view) {
  return pose_in(sensor, keyframe, detect_features(sensor, view.gray, view.inverse_depth));
}

std::vector<RelocalisationCandidate> find_relocalisation_candidates(
    const Sensor& sensor, const std::vector<Keyframe>& keyframes, const FrameView& view,
    int excluded_segment) {
  std::vector<RelocalisationCandidate> candidates;
  const Features frame = detect_features(sensor, view.gray, view.inverse_depth);
  for (const std::size_t k : similar_keyframes(keyframes, view.gray, excluded_segment)) {
    if (const auto pose = pose_in(sensor, keyframes[k], frame)) candidates.push_back({k, *pose});
  }
  return candidates;
}

}  // namespace pcavr::tracking
