// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Fewer tags do not suffice: one tag's wrong pose looks like a wrong camera to a camera that
/// stands still.
constexpr std::size_t kMinTags = 3;
/// Frames that are used, spread over the recording: more hardly change the fit.
constexpr std::size_t kMaxFrames = 40;
/// The residual with a corrected camera must be less than this share of that without.
constexpr double kDecisiveShare = 0.4;
/// It must also be less than this share of that with the tags elsewhere.
constexpr double kTagsShare = 0.7;
/// Displacement of a point by the error, as a share of its distance: 1 % is 5 px at fx = 525. Below
/// the first, it may come from errors of the tags' poses; beyond the second the scene is useless
/// for contact.
constexpr double kWarning = 0.02;
constexpr double kContradiction = 0.05;

/// Two corners of base tags in one frame. Rays are (x, y, 1) times depth.
struct CornerPair {
  std::pair<std::size_t, std::size_t> corners;  ///< which: four of each marker
  Eigen::Vector3d p_camera;
  Eigen::Vector3d q_camera;
  double stated = 0.0;  ///< [m]
};

/// Possible errors of the camera; lengths are scaled by a wrong unit of depth, too.
enum Unknown { kScale, kShiftX, kShiftY, kRadial, kUnknowns };
using Camera = std::array<double, kUnknowns>;
constexpr Camera kAsGiven{1.0, 0.0, 0.0, 0.0};

/// Position of a point with a camera that is corrected by shifts of its normalised coordinates and
/// by a radial term.
Eigen::Vector3d corrected(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Vector2d shifted =
      p.head<2>() / p.z() + Eigen::Vector2d(camera[kShiftX], camera[kShiftY]);
  const Eigen::Vector2d ray = shifted * (1.0 + camera[kRadial] * shifted.squaredNorm());
  return camera[kScale] * p.z() * ray.homogeneous();
}

double length(const Camera& camera, const CornerPair& pair) {
  return (corrected(camera, pair.p_camera) - corrected(camera, pair.q_camera)).norm();
}

double residual(const Camera& camera, const CornerPair& pair) {
  return length(camera, pair) - pair.stated;
}

double median_residual(const Camera& camera, const std::vector<CornerPair>& pairs) {
  std::vector<double> residuals;
  residuals.reserve(pairs.size());
  for (const CornerPair& pair : pairs) residuals.push_back(std::abs(residual(camera, pair)));
  return median(std::move(residuals));
}

/// Residual if each distance is another than stated, but the same in all frames: the tags are
/// elsewhere or of another size, and the camera as given is right.
double residual_of_moved_tags(const std::vector<CornerPair>& pairs) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> lengths;
  for (const CornerPair& pair : pairs) lengths[pair.corners].push_back(length(kAsGiven, pair));
  std::vector<double> residuals;
  residuals.reserve(pairs.size());
  for (const auto& [corners, all] : lengths) {
    const double typical = median(all);
    for (const double one : all) residuals.push_back(std::abs(one - typical));
  }
  return median(std::move(residuals));
}

/// Least squares with Huber weights by Gauss-Newton; all other unknowns stay as given.
Camera fit(const std::vector<Unknown>& unknowns, const std::vector<CornerPair>& pairs) {
  constexpr int kSteps = 12;
  constexpr double kDifference = 1e-6;
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  Camera camera = kAsGiven;
  for (int step = 0; step < kSteps; ++step) {
    const double width = std::max(1e-6, kStdOverMad * median_residual(camera, pairs));
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd gradient(count);
    for (const CornerPair& pair : pairs) {
      const double r = residual(camera, pair);
      for (Eigen::Index i = 0; i < count; ++i) {
        Camera moved = camera;
        moved[unknowns[static_cast<std::size_t>(i)]] += kDifference;
        gradient[i] = (residual(moved, pair) - r) / kDifference;
      }
      const double weight = std::abs(r) <= width ? 1.0 : width / std::abs(r);
      left += weight * gradient * gradient.transpose();
      right -= weight * r * gradient;
    }
    const Eigen::VectorXd change = left.ldlt().solve(right);
    if (!change.allFinite()) return kAsGiven;
    for (Eigen::Index i = 0; i < count; ++i) {
      camera[unknowns[static_cast<std::size_t>(i)]] += change[i];
    }
  }
  return camera;
}

/// Corners of base tags in one frame, and how far apart they are by the manifest.
std::vector<CornerPair> corner_pairs(const Manifest& manifest,
                                     const std::vector<TagMeasurement>& tags,
                                     const std::set<std::size_t>& frames) {
  std::vector<CornerPair> pairs;
  const auto corners_base = [&](const TagMeasurement& tag) {
    const MarkerEntry& marker = manifest.markers[tag.marker];
    auto corners = tag_corners(marker.size);
    for (Eigen::Vector3d& corner : corners) corner = marker.T_parent_marker * corner;
    return corners;
  };
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!frames.contains(tags[i].frame)) continue;
    const auto first = corners_base(tags[i]);
    for (std::size_t j = i; j < tags.size() && tags[j].frame == tags[i].frame; ++j) {
      const auto second = corners_base(tags[j]);
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = i == j ? a + 1 : 0; b < 4; ++b) {
          pairs.push_back({{4 * tags[i].marker + a, 4 * tags[j].marker + b},
                           tags[i].corners_camera[a],
                           tags[j].corners_camera[b],
                           (first[a] - second[b]).norm()});
        }
      }
    }
  }
  return pairs;
}

/// The measurements of base tags; those of a frame follow each other.
std::vector<TagMeasurement> of_base_tags(const Manifest& manifest,
                                         const std::vector<TagMeasurement>& measurements) {
  std::vector<TagMeasurement> tags;
  for (const TagMeasurement& tag : measurements) {
    if (manifest.markers[tag.marker].role == MarkerRole::base) tags.push_back(tag);
  }
  return tags;
}

/// Frames that show tags, at most kMaxFrames of them.
std::set<std::size_t> frames_with_tags(const std::vector<TagMeasurement>& tags) {
  std::vector<std::size_t> frames;
  for (const TagMeasurement& tag : tags) {
    if (frames.empty() || frames.back() != tag.frame) frames.push_back(tag.frame);
  }
  const std::size_t stride = (frames.size() + kMaxFrames - 1) / kMaxFrames;
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, stride)) {
    chosen.insert(frames[i]);
  }
  return chosen;
}

/// The largest displacement of a point in the image by the error [share of its distance].
double displacement(const CameraModel& camera, const Camera& found) {
  const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  const double corner = std::hypot(x, y);
  return std::max(std::hypot(found[kShiftX], found[kShiftY]),
                  std::abs(found[kRadial]) * corner * corner * corner);
}

/// `excludes_tags`: other poses of the tags don't explain what is seen.
ConsistencyFinding finding_of(const Manifest& manifest, const Camera& found, double before,
                              double after, std::size_t frames, bool excludes_tags) {
  const CameraModel& camera = *manifest.camera;
  const bool is_radial = found[kRadial] != 0.0;
  const double error = displacement(camera, found);
  ConsistencyFinding finding{.severity = error >= kContradiction && excludes_tags
                                             ? FindingSeverity::contradiction
                                             : FindingSeverity::warning,
                             .file = "recording.yaml",
                             .place = is_radial ? "camera.distortion" : "camera.cx, camera.cy",
                             .message = {},
                             .hint = {},
                             .factor = 1.0 + error,
                             .frames = frames};
  const std::string evidence = fmt::format(
      " in {} frames the base tags' corners are {:.1f} mm off their stated distances (median), "
      "and {:.1f} mm",
      frames, 1e3 * before, 1e3 * after);
  if (is_radial) {
    finding.message = fmt::format(
        "{}{} with k1 {} by {:.2f}; the error displaces points at the "
        "image's corners by {:.0f} mm at 1 m",
        "as given,", evidence, found[kRadial] > 0.0 ? "smaller" : "larger",
        std::abs(found[kRadial]), 1e3 * error);
    finding.hint = "check that the distortion is that of these images, and not of rectified ones";
  } else {
    finding.message = fmt::format(
        "{:.1f} and {:.1f} px, but{} with {:.0f} and {:.0f} px; the error displaces points by "
        "{:.0f} mm at 1 m",
        camera.cx, camera.cy, evidence, camera.cx - camera.fx * found[kShiftX],
        camera.cy - camera.fy * found[kShiftY], 1e3 * error);
    finding.hint = "check that cx and cy belong to images of this size, and were not cropped";
  }
  if (!excludes_tags) finding.hint += "; or the poses of the base markers";
  return finding;
}

}  // namespace

std::optional<ConsistencyFinding> check_principal_point(
    const Manifest& manifest, const std::vector<TagMeasurement>& measurements,
    std::size_t min_frames, const ConsistencyOptions&) {
  if (!manifest.camera) return std::nullopt;
  const std::vector<TagMeasurement> tags = of_base_tags(manifest, measurements);
  const std::set<std::size_t> frames = frames_with_tags(tags);
  if (frames.empty() || frames.size() < min_frames) return std::nullopt;
  const std::vector<CornerPair> pairs = corner_pairs(manifest, tags, frames);
  const double before = median_residual(fit({kScale}, pairs), pairs);
  const double by_tags = residual_of_moved_tags(pairs);
  Camera best = kAsGiven;
  double after = kDecisiveShare * before;
  for (const auto& unknowns :
       {std::vector<Unknown>{kScale, kShiftX, kShiftY}, std::vector<Unknown>{kScale, kRadial}}) {
    const Camera found = fit(unknowns, pairs);
    const double left = median_residual(found, pairs);
    if (left >= after) continue;
    best = found;
    after = left;
  }
  if (displacement(*manifest.camera, best) < kWarning) return std::nullopt;
  std::set<std::size_t> markers;
  for (const TagMeasurement& tag : tags) markers.insert(tag.marker);
  const bool excludes_tags = after < kTagsShare * by_tags;
  if (!excludes_tags && markers.size() < kMinTags) return std::nullopt;
  return finding_of(manifest, best, before, after, frames.size(), excludes_tags);
}

std::optional<std::string> unchecked_camera(const Manifest& manifest) {
  if (!manifest.camera) return std::nullopt;
  const auto base_tags =
      std::count_if(manifest.markers.begin(), manifest.markers.end(),
                    [](const MarkerEntry& marker) { return marker.role == MarkerRole::base; });
  if (base_tags >= static_cast<std::ptrdiff_t>(kMinTags)) return std::nullopt;
  return fmt::format(
      "they {}; 10 px too many displace all that is seen by {:.0f} mm at 1 m",
      base_tags == 0
          ? "are not checked without base tags"
          : "are checked only as far as the camera moves around the base tags (3 or more: "
            "also where it stands still)",
      1e4 / manifest.camera->fx);
}

}  // namespace pcavr
