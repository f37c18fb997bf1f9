// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/tracking/object_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"

#include "perception/tracking/object_fit.hpp"
#include "perception/tracking/object_normals.hpp"
#include "perception/tracking/object_rest.hpp"

namespace pcavr {

using tracking::CornerObservation;
using tracking::FitProblem;
using tracking::FitResult;
using tracking::PoseMeasurement;
using tracking::PosePrior;
using tracking::RestFilter;
using tracking::ShapeAgreement;
using tracking::SmoothNormals;

namespace {

/// Unknown acceleration averages out over longer times: pushes are short [s].
constexpr double kMaxAccelerationTime = 0.5;

Matrix6d diagonal(double translation_variance, double rotation_variance) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation_variance),
      Eigen::Vector3d::Constant(rotation_variance);
  return variances.asDiagonal();
}

Matrix6d inverse(const Matrix6d& matrix) { return matrix.ldlt().solve(Matrix6d::Identity()); }

/// Covariance that unknown acceleration adds in `dt` seconds.
Matrix6d process_noise(const ObjectTrackerOptions& options, double dt) {
  const double bounded = std::min(dt, kMaxAccelerationTime);
  const double half = 0.5 * bounded * bounded;
  return diagonal(std::pow(options.acceleration_std * half, 2),
                  std::pow(options.angular_acceleration_std * half, 2));
}

double inlier_ratio(const ShapeAgreement& agreement) {
  const int all = agreement.inliers + agreement.behind + agreement.occluded;
  return all == 0 ? 0.0 : static_cast<double>(agreement.inliers) / all;
}

bool is_confirmed(const ObjectTrackerOptions& options, const ShapeAgreement& agreement,
                  double min_inlier_ratio) {
  return agreement.inliers >= options.min_inliers && inlier_ratio(agreement) >= min_inlier_ratio &&
         agreement.behind <= options.max_behind_ratio * agreement.inliers &&
         agreement.normalised_rms <= options.max_normalised_rms;
}

std::vector<CornerObservation> observe_corners(const TagPlacement& tag,
                                               const TagDetection& detection,
                                               const CameraModel& camera) {
  std::vector<CornerObservation> observations;
  const std::array<Eigen::Vector3d, 4> corners_marker = tag_corners(tag.size);
  for (std::size_t i = 0; i < 4; ++i) {
    observations.push_back(
        {tag.T_body_marker * corners_marker[i], camera.normalise(detection.corners[i])});
  }
  return observations;
}

double reprojection_rms(const std::vector<CornerObservation>& observations,
                        const Pose& T_camera_object, const CameraModel& camera) {
  double sum = 0.0;
  for (const CornerObservation& observation : observations) {
    const Eigen::Vector3d p_camera = T_camera_object * observation.p_object;
    sum += tracking::reprojection_error(camera, observation, p_camera).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(observations.size()));
}

/// Predicted pose of the object before the measurement update.
struct Prediction {
  Pose T_base_object;
  Matrix6d covariance = Matrix6d::Zero();  ///< of [v; w] in object axes
};

}  // namespace

struct ObjectTracker::State {
  State(CadModel body, std::vector<TagPlacement> placements, const CameraModel& camera_model,
        const ObjectTrackerOptions& chosen)
      : model(std::move(body)),
        surface(model.mesh_object),
        normals(model.mesh_object),
        tags(std::move(placements)),
        camera(camera_model),
        depth_camera(camera_model),
        options(chosen),
        rest(chosen.rest) {}

  CadModel model;
  SurfaceQuery surface;
  SmoothNormals normals;
  std::vector<TagPlacement> tags;
  CameraModel camera;
  CameraModel depth_camera;  ///< the same at the resolution of the frame's depth image
  ObjectTrackerOptions options;

  RestFilter rest;
  std::optional<ObjectObservation> last;  ///< the last one that was not lost
  Vector6d velocity = Vector6d::Zero();   ///< of [v; w] in object axes, per second
  std::optional<Pose> T_base_object_initial;

  [[nodiscard]] std::optional<Prediction> predict(Stamp stamp) const;
  [[nodiscard]] FitProblem problem(const RgbdFrame& frame) const;
  [[nodiscard]] std::vector<CornerObservation> corners(const std::vector<TagDetection>& detections,
                                                       const Pose& T_camera_object) const;
  [[nodiscard]] Pose resolve_ambiguity(const BodyPose& body, const FitProblem& fit) const;
  [[nodiscard]] PoseMeasurement measure_with_tags(const RgbdFrame& frame,
                                                  const std::vector<TagDetection>& detections,
                                                  const BodyPose& body, const Pose& T_base_camera,
                                                  ObjectObservation& observation) const;
  [[nodiscard]] PoseMeasurement measure_by_shape(const RgbdFrame& frame,
                                                 const Prediction& prediction,
                                                 const Pose& T_base_camera,
                                                 ObjectObservation& observation) const;
  void accept(const PoseMeasurement& measurement, ObjectObservation& observation);
  void update_velocity(const ObjectObservation& observation);
};

std::optional<Prediction> ObjectTracker::State::predict(Stamp stamp) const {
  if (!last) {
    if (!T_base_object_initial) return std::nullopt;
    return Prediction{*T_base_object_initial,
                      diagonal(options.initial_translation_std * options.initial_translation_std,
                               options.initial_rotation_std * options.initial_rotation_std)};
  }
  const double dt = to_seconds(stamp - last->stamp);
  const Vector6d motion =
      dt < options.max_prediction_time ? Vector6d(dt * velocity) : Vector6d(Vector6d::Zero());
  return Prediction{last->T_base_object * Pose::exp(motion),
                    last->covariance + process_noise(options, dt)};
}

FitProblem ObjectTracker::State::problem(const RgbdFrame& frame) const {
  const double dt = to_seconds(frame.color_stamp - frame.depth_stamp);
  return {.surface_object = surface,
          .normals_object = normals,
          .camera = camera,
          .depth_camera = depth_camera,
          .depth = frame.depth,
          .options = options,
          .motion_to_color = Pose::exp(dt * velocity)};
}

/// The corners of all tags that are inliers of the bundle's pose.
std::vector<CornerObservation> ObjectTracker::State::corners(
    const std::vector<TagDetection>& detections, const Pose& T_camera_object) const {
  std::vector<CornerObservation> all;
  for (const TagDetection& detection : detections) {
    const auto tag = std::find_if(tags.begin(), tags.end(), [&](const TagPlacement& placement) {
      return placement.id == detection.id;
    });
    if (tag == tags.end()) continue;
    const std::vector<CornerObservation> own = observe_corners(*tag, detection, camera);
    if (!(reprojection_rms(own, T_camera_object, camera) <= options.max_tag_residual)) continue;
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

/// Resolves a planar ambiguity of the tags: the solution with more depth inliers on the CAD
/// surface.
Pose ObjectTracker::State::resolve_ambiguity(const BodyPose& body, const FitProblem& fit) const {
  if (body.status != BodyPoseStatus::ambiguous || !body.second_solution) {
    return body.pose.T_camera_body;
  }
  const Pose& second = body.second_solution->T_camera_body;
  const double first_ratio = inlier_ratio(evaluate_shape(fit, body.pose.T_camera_body));
  return inlier_ratio(evaluate_shape(fit, second)) > first_ratio ? second : body.pose.T_camera_body;
}

PoseMeasurement ObjectTracker::State::measure_with_tags(const RgbdFrame& frame,
                                                        const std::vector<TagDetection>& detections,
                                                        const BodyPose& body,
                                                        const Pose& T_base_camera,
                                                        ObjectObservation& observation) const {
  observation.evidence = ObjectEvidence::tags;
  observation.tags_used = body.tags_used;
  FitProblem fit = problem(frame);
  const Pose T_color_tags = resolve_ambiguity(body, fit);
  const Pose T_camera_tags = T_color_tags * fit.motion_to_color.inverse();
  const PoseMeasurement by_tags{T_base_camera * T_camera_tags, inverse(body.covariance)};
  if (!options.refine_with_depth) return by_tags;

  fit.corners = corners(detections, T_color_tags);
  if (fit.corners.empty()) return by_tags;
  const FitResult refined = fit_object(fit, T_camera_tags, options.capture_range);
  observation.inlier_ratio = inlier_ratio(refined.agreement);
  observation.surface_rms = refined.agreement.rms;
  const double corner_rms =
      reprojection_rms(fit.corners, refined.T_camera_object * fit.motion_to_color, camera);
  const double max_corner_rms = std::hypot(reprojection_rms(fit.corners, T_color_tags, camera),
                                           options.max_corner_shift * options.body_pose.corner_std);
  if (corner_rms > max_corner_rms ||
      !is_confirmed(options, refined.agreement, options.min_inlier_ratio_with_tags)) {
    return by_tags;
  }
  observation.evidence = ObjectEvidence::tags_and_shape;
  observation.refinement_translation = translation_distance(T_camera_tags, refined.T_camera_object);
  observation.refinement_rotation = rotation_distance(T_camera_tags, refined.T_camera_object);
  return {T_base_camera * refined.T_camera_object,
          refined.corner_information + refined.depth_information};
}

PoseMeasurement ObjectTracker::State::measure_by_shape(const RgbdFrame& frame,
                                                       const Prediction& prediction,
                                                       const Pose& T_base_camera,
                                                       ObjectObservation& observation) const {
  const Pose T_camera_predicted = T_base_camera.inverse() * prediction.T_base_object;
  FitProblem fit = problem(frame);
  fit.prior = PosePrior{T_camera_predicted, inverse(prediction.covariance)};
  const FitResult found = fit_object(fit, T_camera_predicted, options.capture_range);
  observation.inlier_ratio = inlier_ratio(found.agreement);
  observation.surface_rms = found.agreement.rms;
  if (is_confirmed(options, found.agreement, options.min_inlier_ratio_shape_only))
    observation.evidence = ObjectEvidence::shape;
  observation.covariance = inverse(fit.prior->information + found.depth_information);
  return {T_base_camera * found.T_camera_object, found.depth_information};
}

/// Averages measurements with tags while the object is at rest. Measurements by shape alone are not
/// averaged: the average would outweigh their weak information on sliding along the faces.
void ObjectTracker::State::accept(const PoseMeasurement& measurement,
                                  ObjectObservation& observation) {
  observation.T_base_object = measurement.T_base_object;
  if (observation.evidence != ObjectEvidence::shape) {
    const RestFilter::Estimate estimate = rest.add(measurement);
    observation.T_base_object = estimate.T_base_object;
    observation.covariance = estimate.covariance;
    observation.is_at_rest = estimate.is_at_rest;
  }
  update_velocity(observation);
  last = observation;
}

void ObjectTracker::State::update_velocity(const ObjectObservation& observation) {
  Vector6d current = Vector6d::Zero();
  if (!observation.is_at_rest && last) {
    const double dt = to_seconds(observation.stamp - last->stamp);
    if (dt < options.max_prediction_time) {
      current = (last->T_base_object.inverse() * observation.T_base_object).log() / dt;
    }
  }
  // Mean with the previous value: half the noise of a difference, at half a frame of lag.
  velocity = observation.is_at_rest ? current : Vector6d(0.5 * (velocity + current));
  if (observation.evidence == ObjectEvidence::shape) velocity *= options.velocity_decay;
}

ObjectTracker::ObjectTracker(CadModel model, std::vector<TagPlacement> tags,
                             const CameraModel& camera, const ObjectTrackerOptions& options) {
  PCAVR_REQUIRE(options.body_pose.corner_std > 0.0, options.body_pose.corner_std);
  PCAVR_REQUIRE(options.depth_bias >= 0.0, options.depth_bias);
  PCAVR_REQUIRE(options.max_samples >= 100, options.max_samples);
  state_ = std::make_unique<State>(std::move(model), std::move(tags), camera, options);
}
ObjectTracker::~ObjectTracker() = default;
ObjectTracker::ObjectTracker(ObjectTracker&&) noexcept = default;
ObjectTracker& ObjectTracker::operator=(ObjectTracker&&) noexcept = default;

const CadModel& ObjectTracker::model() const { return state_->model; }
const SurfaceQuery& ObjectTracker::surface() const { return state_->surface; }

void ObjectTracker::set_initial_pose(const Pose& T_base_object) {
  state_->T_base_object_initial = T_base_object;
}

ObjectObservation ObjectTracker::track(const RgbdFrame& frame,
                                       const std::vector<TagDetection>& detections,
                                       const Pose& T_base_camera,
                                       const CameraUncertainty& camera_uncertainty) {
  State& state = *state_;
  PCAVR_REQUIRE(!state.last || frame.depth_stamp > state.last->stamp,
                frame.depth_stamp.nanoseconds);
  state.depth_camera = on_grid(state.camera, frame.depth.width(), frame.depth.height());
  const std::optional<Prediction> prediction = state.predict(frame.depth_stamp);
  ObjectObservation observation;
  observation.stamp = frame.depth_stamp;
  if (prediction) observation.T_base_object = prediction->T_base_object;
  if (prediction) observation.covariance = prediction->covariance;

  BodyPoseHints hints{.depth = &frame.depth, .depth_noise = state.options.depth_noise};
  if (prediction) hints.T_camera_body = T_base_camera.inverse() * prediction->T_base_object;
  const BodyPose body =
      solve_body_pose(state.tags, detections, state.camera, hints, state.options.body_pose);
  PoseMeasurement measurement;
  if (body.status == BodyPoseStatus::solved || body.status == BodyPoseStatus::ambiguous) {
    measurement = state.measure_with_tags(frame, detections, body, T_base_camera, observation);
  } else if (prediction) {
    measurement = state.measure_by_shape(frame, *prediction, T_base_camera, observation);
  }
  if (observation.evidence == ObjectEvidence::none) return observation;

  const double range = (T_base_camera.inverse() * measurement.T_base_object).translation().norm();
  const double rotation_variance = std::pow(camera_uncertainty.rotation, 2);
  measurement.camera_covariance =
      diagonal(std::pow(camera_uncertainty.position, 2) + rotation_variance * range * range,
               rotation_variance);
  state.accept(measurement, observation);
  if (observation.evidence == ObjectEvidence::shape) {
    observation.covariance += measurement.camera_covariance;
  }
  return observation;
}

}  // namespace pcavr
