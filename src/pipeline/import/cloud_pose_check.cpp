// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "cloud_pose_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <utility>

#include "pcavr/recordings/cloud/cloud_alignment.hpp"

namespace pcavr {
namespace {

/// Overlap below which poses that no hypothesis explains are doubtful: a sequence shows the same
/// place again.
constexpr double kDoubtfulOverlap = 0.3;
/// A hypothesis explains the clouds where they overlap by this much more, and this many times fewer
/// points are left without one of the other cloud. Right poses are 0.12 and 1.36 times better than
/// the best of the wrong ones on recordings with camera errors of a voxel or two.
constexpr double kExplainedOverlap = 0.1;
constexpr double kExplainedRatio = 1.25;
/// Smallest overlap of a right hypothesis: the best of all reaches 0.45 by chance where the poses
/// are wrong in another way.
constexpr double kPlausibleOverlap = 0.5;
constexpr std::size_t kComparedPairs = 8;
/// Points of all pairs together, enough for a mean overlap with a std of 0.01.
constexpr std::size_t kComparedPoints = 2000;

/// The poses meant, if those of the file are wrong in this way.
struct PoseHypothesis {
  std::string name;
  std::string hint;
  std::function<Pose(const Pose&)> meant;
};

/// Axes of a frame as signed axes of another: "(x, z, -y)".
struct Axes {
  std::string text;
  Eigen::Matrix3d matrix;
};

/// The 48 ways to name and direct the three axes; the first is the axes as they are.
std::vector<Axes> all_axes() {
  std::vector<Axes> all;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      Axes axes{"(", Eigen::Matrix3d::Zero()};
      for (std::size_t i = 0; i < 3; ++i) {
        const bool is_negative = (signs >> i & 1U) != 0;
        axes.matrix(static_cast<int>(i), order[i]) = is_negative ? -1.0 : 1.0;
        axes.text += (i == 0 ? "" : ", ") + std::string(is_negative ? "-" : "") +
                     "xyz"[static_cast<std::size_t>(order[i])];
      }
      axes.text += ")";
      all.push_back(std::move(axes));
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

Pose with_axes(const Pose& pose, const Eigen::Matrix3d& S) {
  const Eigen::Matrix3d R = S * pose.rotation_matrix() * S.transpose();
  return Pose(Eigen::Quaterniond(R).normalized(), S * pose.translation());
}

/// Errors of the axes S. Signs and names of the world's axes alone change no overlap.
void add_axes_hypotheses(const Axes& axes, std::vector<PoseHypothesis>& hypotheses) {
  const Eigen::Matrix3d S = axes.matrix;
  const std::string read_as = " their axes read as " + axes.text;
  hypotheses.push_back({"wrong in the axes of their positions, which fit with" + read_as,
                        "write positions in the frame of the rotations", [S](const Pose& pose) {
                          return Pose(pose.rotation(), S * pose.translation());
                        }});
  const bool is_left = S.determinant() < 0.0;
  hypotheses.push_back({(is_left ? "of a left-handed frame; they fit with"
                                 : "wrong in the axes of the clouds' frames; they fit with") +
                            read_as,
                        is_left ? "write poses of right-handed frames"
                                : "write poses of the frames that the points are in",
                        [S](const Pose& pose) { return with_axes(pose, S); }});
  hypotheses.push_back({"of a left-handed frame; they fit with inverted rotations and" + read_as,
                        "write poses of right-handed frames", [S](const Pose& pose) {
                          const Pose read = with_axes(pose, S);
                          return Pose(read.rotation().conjugate(), read.translation());
                        }});
}

/// The first are the poses as given.
const std::vector<PoseHypothesis>& pose_hypotheses() {
  static const std::vector<PoseHypothesis> hypotheses = [] {
    std::vector<PoseHypothesis> all{
        {"", "", [](const Pose& pose) { return pose; }},
        {"inverted", "write the pose of the cloud's frame in the world, T_world_cloud",
         [](const Pose& pose) { return pose.inverse(); }},
        {"in millimetres", "write positions in metres",
         [](const Pose& pose) { return Pose(pose.rotation(), pose.translation() * 1e-3); }},
        {"inverted in their rotations", "write the rotation of the cloud's frame in the world",
         [](const Pose& pose) { return Pose(pose.rotation().conjugate(), pose.translation()); }},
        {"wrong in the order of their quaternions", "write tx ty tz qx qy qz qw",
         [](const Pose& pose) {
           const Eigen::Vector4d q = pose.rotation().coeffs();
           return Pose(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), pose.translation());
         }}};
    for (const Axes& axes : all_axes()) add_axes_hypotheses(axes, all);
    return all;
  }();
  return hypotheses;
}

std::vector<Eigen::Vector3f> some_of(const std::vector<Eigen::Vector3f>& points,
                                     std::size_t count) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / count);
  std::vector<Eigen::Vector3f> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

/// The mean overlap of pairs of clouds along the sequence, by each hypothesis; empty without a
/// pair.
std::vector<double> mean_overlaps(const std::vector<Pose>& T_world_cloud,
                                  const std::vector<std::vector<Eigen::Vector3f>>& clouds,
                                  double voxel, Parallelism parallelism) {
  const std::vector<PoseHypothesis>& hypotheses = pose_hypotheses();
  const std::size_t step = compared_cloud_step(clouds.size());
  std::vector<std::vector<CloudAgreement>> pairs((clouds.size() - 1) / step);
  if (pairs.empty()) return {};
  const std::size_t points = kComparedPoints / pairs.size();
  parallel_for(parallelism, pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pair = begin; pair < end; ++pair) {
      const std::size_t a = pair * step;
      const std::size_t b = a + step;
      std::vector<Pose> T_a_b;
      T_a_b.reserve(hypotheses.size());
      for (const PoseHypothesis& hypothesis : hypotheses) {
        T_a_b.push_back(hypothesis.meant(T_world_cloud[a]).inverse() *
                        hypothesis.meant(T_world_cloud[b]));
      }
      pairs[pair] = compare_clouds(clouds[a], some_of(clouds[b], points), T_a_b, voxel);
    }
  });
  std::vector<double> means(hypotheses.size(), 0.0);
  for (const std::vector<CloudAgreement>& pair : pairs) {
    for (std::size_t i = 0; i < means.size(); ++i) {
      means[i] += pair[i].overlap / static_cast<double>(pairs.size());
    }
  }
  return means;
}

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

}  // namespace

std::size_t compared_cloud_step(std::size_t clouds) {
  return std::max<std::size_t>(1, clouds / (kComparedPairs + 1));
}

Expected<void> check_cloud_poses(const std::vector<Pose>& T_world_cloud,
                                 const std::vector<std::vector<Eigen::Vector3f>>& thinned_clouds,
                                 double voxel, const std::filesystem::path& file,
                                 Parallelism parallelism, const Observer& observer) {
  const std::vector<double> overlaps =
      mean_overlaps(T_world_cloud, thinned_clouds, voxel, parallelism);
  if (overlaps.empty()) return {};
  const double given = overlaps.front();
  const auto best = std::max_element(overlaps.begin(), overlaps.end());
  if (*best >= kPlausibleOverlap && *best >= given + kExplainedOverlap &&
      1.0 - given >= kExplainedRatio * (1.0 - *best)) {
    const PoseHypothesis& hypothesis =
        pose_hypotheses()[static_cast<std::size_t>(best - overlaps.begin())];
    return Error{.message = "the poses are " + hypothesis.name +
                            ": as given, clouds that follow each other overlap by " +
                            percent(given) + ", else by " + percent(*best),
                 .file = file.string(),
                 .hint = hypothesis.hint};
  }
  if (given < kDoubtfulOverlap) {
    observer.on_warning(file.string() +
                        ": by these poses, clouds that follow each other overlap by " +
                        percent(given) + " only; if they show one place, check the poses");
  }
  return {};
}

}  // namespace pcavr
