// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/evaluation/object_errors.hpp"

#include <algorithm>

#include "pcavr/core/check.hpp"

#include "matched_poses.hpp"

namespace pcavr {
namespace {

/// Of the fastest vertex, over the span around `stamp` [m/s].
double speed_at(const Trajectory& reference, const std::vector<Eigen::Vector3f>& vertices_object,
                Stamp stamp, Duration span) {
  const Pose before = pose_near(reference, stamp + -span / 2);
  const Pose after = pose_near(reference, stamp + span / 2);
  return model_error(vertices_object, before, after).mssd / to_seconds(span);
}

}  // namespace

ModelError model_error(const std::vector<Eigen::Vector3f>& vertices_object,
                       const Pose& T_base_object_reference, const Pose& T_base_object_estimate) {
  PCAVR_REQUIRE(!vertices_object.empty());
  ModelError error;
  double sum = 0.0;
  for (const Eigen::Vector3f& vertex : vertices_object) {
    const Eigen::Vector3d p_object = vertex.cast<double>();
    const double distance =
        (T_base_object_reference * p_object - T_base_object_estimate * p_object).norm();
    sum += distance;
    error.mssd = std::max(error.mssd, distance);
  }
  error.add = sum / static_cast<double>(vertices_object.size());
  return error;
}

ObjectErrors object_errors(const TriangleMesh& mesh_object, const Trajectory& reference,
                           const Trajectory& estimate, const TrajectoryErrorOptions& options) {
  PCAVR_REQUIRE(!mesh_object.vertices.empty());
  ObjectErrors errors;
  std::vector<double> add;
  std::vector<double> mssd;
  for (const MatchedPose& pair : match(reference, estimate, options.longest_gap)) {
    ModelError error = model_error(mesh_object.vertices, pair.reference, pair.estimate);
    error.stamp = pair.stamp;
    add.push_back(error.add);
    mssd.push_back(error.mssd);
    errors.poses.push_back(error);
  }
  errors.add = statistics(std::move(add));
  errors.mssd = statistics(std::move(mssd));
  return errors;
}

std::vector<bool> is_moving(const Trajectory& reference,
                            const std::vector<Eigen::Vector3f>& vertices_object,
                            const std::vector<Stamp>& stamps, const MotionOptions& options) {
  PCAVR_REQUIRE(!reference.empty());
  PCAVR_REQUIRE(options.span > Duration::zero());
  const std::vector<Eigen::Vector3f> origin = {Eigen::Vector3f::Zero()};
  const std::vector<Eigen::Vector3f>& vertices = vertices_object.empty() ? origin : vertices_object;
  std::vector<bool> moving;
  bool now = false;
  for (const Stamp stamp : stamps) {
    const double speed = speed_at(reference, vertices, stamp, options.span);
    now = speed >= (now ? options.speed_to_stop : options.speed_to_start);
    moving.push_back(now);
  }
  return moving;
}

}  // namespace pcavr
