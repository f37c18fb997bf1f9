// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/surface_errors.hpp"

#include <algorithm>
#include <atomic>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/results/evaluation/object_errors.hpp"

#include "surface_samples.hpp"
#include "visibility.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kSampleGrain = 1024;  // samples per task

/// An upper bound of the distance between any two points of the meshes [m].
float max_distance(const TriangleMesh& a, const TriangleMesh& b) {
  Eigen::AlignedBox3f box = bounds(a.vertices);
  box.extend(bounds(b.vertices));
  return 1.0F + box.diagonal().norm();
}

/// Distance from each sample to the nearest point of the surface [m], or `radius` where that is
/// farther.
std::vector<double> distances(const std::vector<SurfaceSample>& samples,
                              const SurfaceQuery& surface, float radius, Parallelism parallelism) {
  std::vector<double> result(samples.size());
  parallel_for(parallelism, samples.size(), kSampleGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto closest = surface.closest(samples[i].point, radius);
      result[i] = static_cast<double>(closest ? closest->distance : radius);
    }
  });
  return result;
}

/// Share of ascending distances that is at most `limit`.
double share_within(const std::vector<double>& ascending, double limit) {
  if (ascending.empty()) return 0.0;
  const auto beyond = std::upper_bound(ascending.begin(), ascending.end(), limit);
  return static_cast<double>(beyond - ascending.begin()) / static_cast<double>(ascending.size());
}

/// The samples of the truth that count for completeness.
std::vector<SurfaceSample> seen_samples(const TriangleMesh& truth_base,
                                        const SurfaceQuery& truth_query,
                                        const std::optional<Views>& views,
                                        const SurfaceErrorOptions& options,
                                        Parallelism parallelism) {
  std::vector<SurfaceSample> samples =
      sample_surface(truth_base, options.sample_spacing, options.seed);
  if (!views) return samples;
  const std::vector<std::uint8_t> seen = seen_by_any(samples, truth_query, *views, parallelism);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (seen[i] != 0) samples[kept++] = samples[i];
  }
  samples.resize(kept);
  return samples;
}

/// The volume swept by a body over its poses.
class SweptVolume {
 public:
  explicit SweptVolume(const MovedBody& body) : surface_object_(body.mesh_object) {
    // Poses of a body at rest repeat: skips those that move no vertex by a millimetre.
    constexpr double kMinPoseChange = 0.001;
    const std::vector<Eigen::Vector3f>& vertices = body.mesh_object.vertices;
    const Pose* last = nullptr;
    for (const Pose& T_base_object : body.T_base_object) {
      if (last != nullptr && model_error(vertices, *last, T_base_object).mssd < kMinPoseChange)
        continue;
      last = &T_base_object;
      T_object_base_.push_back(T_base_object.inverse());
    }
  }

  /// Whether the point lies inside the body, or within `margin` of it, at any pose.
  [[nodiscard]] bool contains(const Eigen::Vector3f& p_base, float margin) const {
    return std::any_of(T_object_base_.begin(), T_object_base_.end(), [&](const Pose& pose) {
      const Eigen::Vector3f p_object = (pose * p_base.cast<double>().eval()).cast<float>();
      return surface_object_.closest(p_object, margin).has_value() || is_inside(p_object);
    });
  }

 private:
  /// Ray casting: a ray from inside a closed surface hits a back face. Its direction is along no
  /// axis, since the edges of bodies often are.
  [[nodiscard]] bool is_inside(const Eigen::Vector3f& p_object) const {
    const Eigen::Vector3f direction(0.36F, 0.48F, 0.8F);
    const std::optional<SurfaceQuery::Hit> hit = surface_object_.cast(p_object, direction);
    return hit && hit->normal.dot(direction) > 0.0F;
  }

  SurfaceQuery surface_object_;
  std::vector<Pose> T_object_base_;
};

}  // namespace

MeshErrors mesh_errors(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                       const std::optional<Views>& views, const SurfaceErrorOptions& options,
                       Parallelism parallelism) {
  PCAVR_REQUIRE(!truth_base.triangles.empty());
  MeshErrors errors;
  if (mesh_base.triangles.empty()) return errors;
  const SurfaceQuery truth_query(truth_base);
  const SurfaceQuery mesh_query(mesh_base);
  const float radius = max_distance(truth_base, mesh_base);

  errors.mesh_to_truth = distances(sample_surface(mesh_base, options.sample_spacing, options.seed),
                                   truth_query, radius, parallelism);
  errors.seen_truth_to_mesh =
      distances(seen_samples(truth_base, truth_query, views, options, parallelism), mesh_query,
                radius, parallelism);
  std::sort(errors.mesh_to_truth.begin(), errors.mesh_to_truth.end());
  std::sort(errors.seen_truth_to_mesh.begin(), errors.seen_truth_to_mesh.end());

  errors.accuracy = statistics(errors.mesh_to_truth);
  // The distances are part of the metrics' definitions: reports stay comparable.
  errors.completeness_5mm = share_within(errors.seen_truth_to_mesh, 0.005);
  errors.completeness_10mm = share_within(errors.seen_truth_to_mesh, 0.010);
  if (!errors.mesh_to_truth.empty()) {
    errors.share_not_explained = 1.0 - share_within(errors.mesh_to_truth, 0.020);
  }
  return errors;
}

double share_left_behind(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                         const std::vector<MovedBody>& bodies, const SurfaceErrorOptions& options,
                         Parallelism parallelism) {
  PCAVR_REQUIRE(!truth_base.triangles.empty());
  constexpr float kMaxExplainedDistance =
      0.010F;  // [m]; several times the errors by noise and voxels
  const std::vector<SurfaceSample> samples =
      sample_surface(mesh_base, options.sample_spacing, options.seed);
  if (samples.empty()) return 0.0;
  const SurfaceQuery truth_query(truth_base);
  const std::vector<SweptVolume> swept_volumes(bodies.begin(), bodies.end());
  std::atomic<std::size_t> left_behind = 0;  // a count: the order of the additions does not matter
  parallel_for(parallelism, samples.size(), kSampleGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f& point = samples[i].point;
      if (truth_query.closest(point, kMaxExplainedDistance)) continue;
      found += std::any_of(
          swept_volumes.begin(), swept_volumes.end(),
          [&](const SweptVolume& swept) { return swept.contains(point, kMaxExplainedDistance); });
    }
    left_behind += found;
  });
  return static_cast<double>(left_behind) / static_cast<double>(samples.size());
}

}  // namespace pcavr
