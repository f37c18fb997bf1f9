// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "visibility.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

/// [m] A hit this much nearer than the sample is on the sample's own surface: float coordinates at
/// room scale are exact to a micrometre, and a ray at 75 degrees makes that fourfold.
constexpr float kSelfOcclusionTolerance = 1e-4F;

/// Occlusion test by ray casting from the views to points of the truth. Keeps references.
class Visibility {
 public:
  Visibility(const SurfaceQuery& truth_base, const Views& views)
      : truth_base_(truth_base), views_(views) {
    for (const Pose& T_base_camera : views.T_base_camera) {
      const Pose T_camera_base = T_base_camera.inverse();
      // A matrix is faster: most of the time is spent on points outside every view.
      R_camera_base_.push_back(T_camera_base.rotation_matrix());
      p_camera_base_.push_back(T_camera_base.translation());
    }
    for (const MovedBody& body : views.bodies) {
      PCAVR_REQUIRE(body.T_base_object.size() == views.T_base_camera.size());
      bodies_object_.emplace_back(body.mesh_object);
    }
  }

  [[nodiscard]] bool is_seen(const SurfaceSample& sample_base) const {
    for (std::size_t view = 0; view < R_camera_base_.size(); ++view) {
      if (is_in_view(sample_base, view) && !is_occluded(sample_base.point, view)) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] bool is_in_view(const SurfaceSample& sample_base, std::size_t view) const {
    const Eigen::Vector3d p_camera =
        R_camera_base_[view] * sample_base.point.cast<double>() + p_camera_base_[view];
    const ViewOptions& options = views_.options;
    if (p_camera.z() < options.min_depth || p_camera.z() > options.max_depth) return false;
    if (!is_in_image(p_camera)) return false;
    const Eigen::Vector3d normal_camera = R_camera_base_[view] * sample_base.normal.cast<double>();
    // Both sides: the format does not define the winding of the truth.
    const double cosine = std::abs(p_camera.normalized().dot(normal_camera));
    return cosine >= std::cos(options.max_incidence);
  }

  [[nodiscard]] bool is_in_image(const Eigen::Vector3d& p_camera) const {
    const Eigen::Vector2d pixel = views_.camera.project(p_camera);
    return views_.camera.contains(pixel);
  }

  [[nodiscard]] bool is_occluded(const Eigen::Vector3f& p_base, std::size_t view) const {
    const Eigen::Vector3d eye_base = views_.T_base_camera[view].translation();
    if (is_occluded_by(truth_base_, eye_base, p_base.cast<double>())) return true;
    for (std::size_t body = 0; body < bodies_object_.size(); ++body) {
      const Pose T_object_base = views_.bodies[body].T_base_object[view].inverse();
      if (is_occluded_by(bodies_object_[body], T_object_base * eye_base,
                         T_object_base * p_base.cast<double>().eval())) {
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] static bool is_occluded_by(const SurfaceQuery& surface, const Eigen::Vector3d& eye,
                                           const Eigen::Vector3d& point) {
    const Eigen::Vector3f ray = (point - eye).cast<float>();
    const std::optional<SurfaceQuery::Hit> hit = surface.cast(eye.cast<float>(), ray);
    return hit && hit->distance < ray.norm() - kSelfOcclusionTolerance;
  }

  const SurfaceQuery& truth_base_;
  const Views& views_;
  std::vector<Eigen::Matrix3d> R_camera_base_;
  std::vector<Eigen::Vector3d> p_camera_base_;
  std::vector<SurfaceQuery> bodies_object_;
};

}  // namespace

std::vector<std::uint8_t> seen_by_any(const std::vector<SurfaceSample>& samples_base,
                                      const SurfaceQuery& truth_base, const Views& views,
                                      Parallelism parallelism) {
  const Visibility visibility(truth_base, views);
  std::vector<std::uint8_t> seen(samples_base.size());
  constexpr std::size_t kGrain = 1024;
  parallel_for(parallelism, seen.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      seen[i] = visibility.is_seen(samples_base[i]) ? 1 : 0;
    }
  });
  return seen;
}

}  // namespace pcavr
