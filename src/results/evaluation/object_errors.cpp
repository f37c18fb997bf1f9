// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/object_errors.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/geometry/matched_poses.hpp"

namespace pcavr {
namespace {

/// Poses per task: enough work even for a body of eight vertices.
constexpr std::size_t kPoseGrain = 256;

/// The displacement of a body's point between two poses: difference * p_object + offset.
struct PoseDifference {
  Eigen::Matrix3d difference;
  Eigen::Vector3d offset;

  PoseDifference(const Pose& a, const Pose& b)
      : difference(a.rotation().toRotationMatrix() - b.rotation().toRotationMatrix()),
        offset(a.translation() - b.translation()) {}
  [[nodiscard]] double squared_at(const Eigen::Vector3f& p_object) const {
    return (difference * p_object.cast<double>() + offset).squaredNorm();
  }
};

/// Speed of the fastest vertex over the span around `stamp` [m/s].
double speed_at(const Trajectory& reference, const std::vector<Eigen::Vector3f>& vertices_object,
                Stamp stamp, Duration span) {
  const PoseDifference motion(pose_near(reference, stamp + -span / 2),
                              pose_near(reference, stamp + span / 2));
  double max_squared = 0.0;
  for (const Eigen::Vector3f& vertex : vertices_object) {
    max_squared = std::max(max_squared, motion.squared_at(vertex));
  }
  return std::sqrt(max_squared) / to_seconds(span);
}

}  // namespace

ModelError model_error(const std::vector<Eigen::Vector3f>& vertices_object,
                       const Pose& T_base_object_reference, const Pose& T_base_object_estimate) {
  PCAVR_REQUIRE(!vertices_object.empty());
  const PoseDifference difference(T_base_object_reference, T_base_object_estimate);
  ModelError error;
  double sum = 0.0;
  for (const Eigen::Vector3f& vertex : vertices_object) {
    const double distance = std::sqrt(difference.squared_at(vertex));
    sum += distance;
    error.mssd = std::max(error.mssd, distance);
  }
  error.add = sum / static_cast<double>(vertices_object.size());
  return error;
}

ObjectErrors object_errors(const TriangleMesh& mesh_object, const Trajectory& reference,
                           const Trajectory& estimate, const TrajectoryErrorOptions& options,
                           Parallelism parallelism) {
  PCAVR_REQUIRE(!mesh_object.vertices.empty());
  const std::vector<MatchedPose> pairs =
      match(reference, estimate, duration_from_seconds(options.max_gap));
  ObjectErrors errors;
  errors.poses.resize(pairs.size());
  parallel_for(parallelism, pairs.size(), kPoseGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      errors.poses[i] = model_error(mesh_object.vertices, pairs[i].reference, pairs[i].estimate);
      errors.poses[i].stamp = pairs[i].stamp;
    }
  });
  std::vector<double> add;
  std::vector<double> mssd;
  for (const ModelError& error : errors.poses) {
    add.push_back(error.add);
    mssd.push_back(error.mssd);
  }
  errors.add = statistics(std::move(add));
  errors.mssd = statistics(std::move(mssd));
  return errors;
}

std::vector<bool> is_moving(const Trajectory& reference,
                            const std::vector<Eigen::Vector3f>& vertices_object,
                            const std::vector<Stamp>& stamps, const MotionOptions& options,
                            Parallelism parallelism) {
  PCAVR_REQUIRE(!reference.empty());
  PCAVR_REQUIRE(options.span > 0.0, options.span);
  const Duration span = duration_from_seconds(options.span);
  const std::vector<Eigen::Vector3f> origin = {Eigen::Vector3f::Zero()};
  const std::vector<Eigen::Vector3f>& vertices = vertices_object.empty() ? origin : vertices_object;
  std::vector<double> speeds(stamps.size());
  parallel_for(parallelism, stamps.size(), kPoseGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      speeds[i] = speed_at(reference, vertices, stamps[i], span);
    }
  });
  std::vector<bool> moving;
  bool now = false;
  for (const double speed : speeds) {
    now = speed >= (now ? options.speed_to_stop : options.speed_to_start);
    moving.push_back(now);
  }
  return moving;
}

}  // namespace pcavr
