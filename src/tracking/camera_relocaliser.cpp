// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_relocaliser.hpp"

#include <algorithm>
#include <optional>

#include <Eigen/Geometry>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pcavr/core/random.hpp"

namespace pcavr::tracking {
namespace {

constexpr int kFeatures = 400;
constexpr std::size_t kCandidates = 6;    // keyframes looked at closely
constexpr int kMinInliers = 15;           // chance matches agree in fives at most
constexpr double kInlierDistance = 0.03;  // [m]; the alignment that follows is finer
constexpr int kDraws = 200;               // finds 3 of 20 % inliers with 80 % probability
const cv::Size kThumbnail(40, 30);

struct Described {
  cv::Mat descriptors;
  std::vector<Eigen::Vector3d> points;  ///< in the depth camera [m]
};

/// ORB features with a point in space.
Described describe(const Sensor& sensor, const cv::Mat& gray, const InverseDepth& inverse_depth) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::ORB::create(kFeatures)->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
  Described described;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::Point2f at = keypoints[i].pt;
    const int x = static_cast<int>(at.x) / sensor.grid.pixels;
    const int y = static_cast<int>(at.y) / sensor.grid.pixels;
    if (x >= sensor.grid.width() || y >= sensor.grid.height()) continue;
    const float w = inverse_depth[static_cast<std::size_t>(y * sensor.grid.width() + x)];
    if (w <= 0.0F) continue;
    described.points.push_back(sensor.camera.unproject({at.x, at.y}, 1.0 / double{w}));
    described.descriptors.push_back(descriptors.row(static_cast<int>(i)));
  }
  return described;
}

/// The picture shrunk and freed from brightness and contrast: near views look alike
/// [Klein & Murray 2008].
cv::Mat thumbnail(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, kThumbnail, 0.0, 0.0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(small, mean, deviation);
  small = (small - mean[0]) / std::max(1.0, deviation[0]);
  return small;
}

/// The keyframes that look most like the frame.
std::vector<std::size_t> alike(const std::vector<Keyframe>& keyframes, const cv::Mat& gray,
                               int segment_left_out) {
  const cv::Mat wanted = thumbnail(gray);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    if (keyframes[k].segment == segment_left_out) continue;
    ranked.emplace_back(cv::norm(wanted, thumbnail(keyframes[k].gray), cv::NORM_L2), k);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> best;
  for (const auto& [difference, k] : ranked) {
    if (best.size() < kCandidates) best.push_back(k);
  }
  return best;
}

/// Least squares over pairs (to, from) [Umeyama 1991].
Pose fit_pose(const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& pairs) {
  Eigen::Matrix3Xd to(3, static_cast<Eigen::Index>(pairs.size()));
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    to.col(static_cast<Eigen::Index>(i)) = pairs[i].first;
    from.col(static_cast<Eigen::Index>(i)) = pairs[i].second;
  }
  return Pose::from_matrix(Eigen::umeyama(from, to, false));
}

/// RANSAC [Fischler & Bolles 1981] over pairs of points; nothing where too few agree.
std::optional<Pose> agree_on_pose(
    const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& pairs) {
  if (pairs.size() < kMinInliers) return std::nullopt;
  const auto inliers_of = [&](const Pose& pose) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> inliers;
    for (const auto& pair : pairs) {
      if ((pose * pair.second - pair.first).norm() < kInlierDistance) inliers.push_back(pair);
    }
    return inliers;
  };
  Random random(pairs.size());
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> best;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto& a = pairs[random.below(pairs.size())];
    const auto& b = pairs[random.below(pairs.size())];
    const auto& c = pairs[random.below(pairs.size())];
    const double area = (b.second - a.second).cross(c.second - a.second).norm();
    if (area < 1e-3) continue;  // [m^2]; nearly on one line, or one point twice
    auto inliers = inliers_of(fit_pose({a, b, c}));
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  if (best.size() < kMinInliers) return std::nullopt;
  return fit_pose(inliers_of(fit_pose(best)));
}

}  // namespace

std::vector<RelocalisationStart> find_relocalisation_starts(const Sensor& sensor,
                                                            const std::vector<Keyframe>& keyframes,
                                                            const FrameView& view,
                                                            int segment_left_out) {
  std::vector<RelocalisationStart> starts;
  const Described frame = describe(sensor, view.gray, view.inverse_depth);
  if (frame.points.size() < kMinInliers) return starts;
  const cv::BFMatcher matcher(cv::NORM_HAMMING, true);
  for (const std::size_t k : alike(keyframes, view.gray, segment_left_out)) {
    const Described model = describe(sensor, keyframes[k].gray, keyframes[k].model.inverse_depth);
    if (model.points.size() < kMinInliers) continue;
    std::vector<cv::DMatch> matches;
    matcher.match(frame.descriptors, model.descriptors, matches);
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
    for (const cv::DMatch& match : matches) {
      pairs.emplace_back(model.points[static_cast<std::size_t>(match.trainIdx)],
                         frame.points[static_cast<std::size_t>(match.queryIdx)]);
    }
    if (const auto pose = agree_on_pose(pairs)) starts.push_back({k, *pose});
  }
  return starts;
}

}  // namespace pcavr::tracking
