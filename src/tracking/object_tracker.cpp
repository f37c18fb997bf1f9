// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/tracking/object_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "pcavr/core/check.hpp"
#include "pcavr/geometry/depth_grid.hpp"

#include "tracking/object_fit.hpp"
#include "tracking/object_normals.hpp"
#include "tracking/object_rest.hpp"

namespace pcavr {

using tracking::CornerSight;
using tracking::FitProblem;
using tracking::FitResult;
using tracking::PoseMeasurement;
using tracking::PosePrior;
using tracking::RestFilter;
using tracking::ShapeAgreement;
using tracking::SmoothNormals;

namespace {

/// A tag whose corners lie further than this from where the bundle puts them [px rms] contradicts
/// the others.
constexpr double kContradiction = 3.0;
/// Samples below which the depth says nothing about a body.
constexpr int kMinSamples = 40;
/// Share of the readings on the body that have to lie on its surface: with tags, and without them.
constexpr double kExplainedWithTags = 0.5;
constexpr double kExplainedAlone = 0.3;
/// Share of the readings that may lie behind the surface: the sensor's gross errors, the rim.
constexpr double kMaxContradicted = 0.2;
/// How far the scatter about the surface may exceed the sensor's: above, the CAD body is not this
/// body. Faces that are half a deviation off stay below it.
constexpr double kMaxChi = 1.6;
/// Deviations of the corners by which depth may bend the tags' pose. A CAD body of another size
/// fits the faces that are seen just as well, elsewhere; only the tags tell.
constexpr double kStrainedCorners = 5.0;
/// How far depth may lie from the surface and still be drawn to it [m]: what a tag's pose, or the
/// motion that was not foreseen since the last frame, may be off.
constexpr double kCapture = 0.02;
/// What a body may do unseen: push and friction seldom accelerate it more [m/s^2], [rad/s^2].
constexpr double kAcceleration = 2.0;
constexpr double kAngularAcceleration = 20.0;
constexpr double kMaxPush = 0.5;  // [s]
/// How well a given first pose is taken to be known [m], [rad].
constexpr double kInitialShift = 0.01;
constexpr double kInitialTurn = 0.05;
/// Share of the velocity that shape alone hands on to the next frame: where it shows no motion,
/// nothing else would ever end one.
constexpr double kFadingVelocity = 0.8;
/// A velocity older than this [s] foretells nothing.
constexpr double kMaxForesight = 0.2;

Matrix6d diagonal(double translation_variance, double rotation_variance) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation_variance),
      Eigen::Vector3d::Constant(rotation_variance);
  return variances.asDiagonal();
}

Matrix6d inverse(const Matrix6d& matrix) { return matrix.ldlt().solve(Matrix6d::Identity()); }

/// What unknown acceleration adds in `dt` seconds.
Matrix6d unforeseen_motion(double dt) {
  const double bounded = std::min(dt, kMaxPush);
  const double half = 0.5 * bounded * bounded;
  return diagonal(std::pow(kAcceleration * half, 2), std::pow(kAngularAcceleration * half, 2));
}

double explained_share(const ShapeAgreement& agreement) {
  const int all = agreement.explained + agreement.contradicted + agreement.hidden;
  return all == 0 ? 0.0 : static_cast<double>(agreement.explained) / all;
}

bool is_explained(const ShapeAgreement& agreement, double min_share) {
  return agreement.explained >= kMinSamples && explained_share(agreement) >= min_share &&
         agreement.contradicted <= kMaxContradicted * agreement.explained &&
         agreement.chi <= kMaxChi;
}

std::vector<CornerSight> sights_of(const TagPlacement& tag, const TagDetection& detection,
                                   const CameraModel& camera) {
  std::vector<CornerSight> sights;
  const std::array<Eigen::Vector3d, 4> corners_marker = tag_corners(tag.size);
  for (std::size_t i = 0; i < 4; ++i) {
    sights.push_back(
        {tag.T_body_marker * corners_marker[i], camera.normalise(detection.corners[i])});
  }
  return sights;
}

double reprojection_rms(const std::vector<CornerSight>& sights, const Pose& T_camera_object,
                        const CameraModel& camera) {
  double sum = 0.0;
  for (const CornerSight& sight : sights) {
    const Eigen::Vector3d p_camera = T_camera_object * sight.p_object;
    sum += tracking::corner_offset(camera, sight, p_camera).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(sights.size()));
}

/// Where the object is thought to be before a frame is looked at.
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
        options(chosen) {}

  CadModel model;
  SurfaceQuery surface;
  SmoothNormals normals;
  std::vector<TagPlacement> tags;
  CameraModel camera;
  CameraModel depth_camera;  ///< the same on the grid of the frame's depth image
  ObjectTrackerOptions options;

  RestFilter rest;
  std::optional<ObjectObservation> last;  ///< the last one that was not lost
  Vector6d velocity = Vector6d::Zero();   ///< of [v; w] in object axes, per second
  std::optional<Pose> T_base_object_initial;

  [[nodiscard]] std::optional<Prediction> predict(Stamp stamp) const;
  [[nodiscard]] FitProblem problem(const RgbdFrame& frame) const;
  [[nodiscard]] std::vector<CornerSight> corners(const std::vector<TagDetection>& detections,
                                                 const Pose& T_camera_object) const;
  [[nodiscard]] Pose likelier(const BodyPose& body, const FitProblem& fit) const;
  [[nodiscard]] PoseMeasurement measure_with_tags(const RgbdFrame& frame,
                                                  const std::vector<TagDetection>& detections,
                                                  const BodyPose& body, const Pose& T_base_camera,
                                                  ObjectObservation& observation) const;
  [[nodiscard]] PoseMeasurement measure_by_shape(const RgbdFrame& frame,
                                                 const Prediction& prediction,
                                                 const Pose& T_base_camera,
                                                 ObjectObservation& observation) const;
  void accept(const PoseMeasurement& measurement, ObjectObservation& observation);
  void learn_velocity(const ObjectObservation& observation);
};

std::optional<Prediction> ObjectTracker::State::predict(Stamp stamp) const {
  if (!last) {
    if (!T_base_object_initial) return std::nullopt;
    return Prediction{*T_base_object_initial,
                      diagonal(kInitialShift * kInitialShift, kInitialTurn * kInitialTurn)};
  }
  const double dt = to_seconds(stamp - last->stamp);
  const Vector6d foreseen =
      dt < kMaxForesight ? Vector6d(dt * velocity) : Vector6d(Vector6d::Zero());
  return Prediction{last->T_base_object * Pose::exp(foreseen),
                    last->covariance + unforeseen_motion(dt)};
}

FitProblem ObjectTracker::State::problem(const RgbdFrame& frame) const {
  const double dt = to_seconds(frame.color_stamp - frame.depth_stamp);
  return {.surface_object = surface,
          .normals_object = normals,
          .camera = camera,
          .depth_camera = depth_camera,
          .depth = frame.depth,
          .noise = options.depth_noise,
          .max_samples = options.max_samples,
          .corner_sigma = options.corner_sigma,
          .depth_bias = options.depth_bias,
          .motion_to_color = Pose::exp(dt * velocity)};
}

/// The corners of all tags that agree with the bundle's pose.
std::vector<CornerSight> ObjectTracker::State::corners(const std::vector<TagDetection>& detections,
                                                       const Pose& T_camera_object) const {
  std::vector<CornerSight> all;
  for (const TagDetection& detection : detections) {
    const auto tag = std::find_if(tags.begin(), tags.end(), [&](const TagPlacement& placement) {
      return placement.id == detection.id;
    });
    if (tag == tags.end()) continue;
    const std::vector<CornerSight> own = sights_of(*tag, detection, camera);
    if (!(reprojection_rms(own, T_camera_object, camera) <= kContradiction)) continue;
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

/// Of two planar solutions that the tags can't tell apart, the one that the body's shape explains.
Pose ObjectTracker::State::likelier(const BodyPose& body, const FitProblem& fit) const {
  if (body.status != BodyPoseStatus::ambiguous || !body.alternative) {
    return body.pose.T_camera_body;
  }
  const Pose& other = body.alternative->T_camera_body;
  const double own_share = explained_share(judge_shape(fit, body.pose.T_camera_body));
  return explained_share(judge_shape(fit, other)) > own_share ? other : body.pose.T_camera_body;
}

PoseMeasurement ObjectTracker::State::measure_with_tags(const RgbdFrame& frame,
                                                        const std::vector<TagDetection>& detections,
                                                        const BodyPose& body,
                                                        const Pose& T_base_camera,
                                                        ObjectObservation& observation) const {
  observation.evidence = ObjectEvidence::tags;
  observation.tags_used = body.tags_used;
  FitProblem fit = problem(frame);
  const Pose T_color_tags = likelier(body, fit);
  const Pose T_camera_tags = T_color_tags * fit.motion_to_color.inverse();
  const PoseMeasurement by_tags{T_base_camera * T_camera_tags, inverse(body.covariance)};
  if (!options.refine_with_depth) return by_tags;

  fit.corners = corners(detections, T_color_tags);
  if (fit.corners.empty()) return by_tags;
  const FitResult refined = fit_object(fit, T_camera_tags, kCapture);
  observation.explained = explained_share(refined.agreement);
  observation.surface_rms = refined.agreement.rms;
  const double strained =
      reprojection_rms(fit.corners, refined.T_camera_object * fit.motion_to_color, camera);
  const double allowed = std::hypot(reprojection_rms(fit.corners, T_color_tags, camera),
                                    kStrainedCorners * options.corner_sigma);
  if (strained > allowed || !is_explained(refined.agreement, kExplainedWithTags)) return by_tags;
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
  const FitResult found = fit_object(fit, T_camera_predicted, kCapture);
  observation.explained = explained_share(found.agreement);
  observation.surface_rms = found.agreement.rms;
  if (is_explained(found.agreement, kExplainedAlone)) observation.evidence = ObjectEvidence::shape;
  observation.covariance = inverse(fit.prior->information + found.depth_information);
  return {T_base_camera * found.T_camera_object, found.depth_information};
}

/// Averages what the tags hold while the object rests. Shape alone stands for itself: an average
/// would outweigh the little that it tells of sliding along its own faces.
void ObjectTracker::State::accept(const PoseMeasurement& measurement,
                                  ObjectObservation& observation) {
  observation.T_base_object = measurement.T_base_object;
  if (observation.evidence != ObjectEvidence::shape) {
    const RestFilter::Estimate estimate = rest.add(measurement);
    observation.T_base_object = estimate.T_base_object;
    observation.covariance = estimate.covariance;
    observation.is_at_rest = estimate.is_at_rest;
  }
  learn_velocity(observation);
  last = observation;
}

void ObjectTracker::State::learn_velocity(const ObjectObservation& observation) {
  Vector6d current = Vector6d::Zero();
  if (!observation.is_at_rest && last) {
    const double dt = to_seconds(observation.stamp - last->stamp);
    if (dt < kMaxForesight) {
      current = (last->T_base_object.inverse() * observation.T_base_object).log() / dt;
    }
  }
  // The mean with the last one: half the noise of a difference, half a frame late.
  velocity = observation.is_at_rest ? current : Vector6d(0.5 * (velocity + current));
  if (observation.evidence == ObjectEvidence::shape) velocity *= kFadingVelocity;
}

ObjectTracker::ObjectTracker(CadModel model, std::vector<TagPlacement> tags,
                             const CameraModel& camera, const ObjectTrackerOptions& options) {
  PCAVR_REQUIRE(options.corner_sigma > 0.0, options.corner_sigma);
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
  const BodyPose body = solve_body_pose(state.tags, detections, state.camera, hints,
                                        {.corner_sigma = state.options.corner_sigma});
  PoseMeasurement measurement;
  if (body.status == BodyPoseStatus::solved || body.status == BodyPoseStatus::ambiguous) {
    measurement = state.measure_with_tags(frame, detections, body, T_base_camera, observation);
  } else if (prediction) {
    measurement = state.measure_by_shape(frame, *prediction, T_base_camera, observation);
  }
  if (observation.evidence == ObjectEvidence::none) return observation;

  const double range = (T_base_camera.inverse() * measurement.T_base_object).translation().norm();
  const double turn_variance = std::pow(camera_uncertainty.rotation, 2);
  measurement.camera_covariance = diagonal(
      std::pow(camera_uncertainty.position, 2) + turn_variance * range * range, turn_variance);
  state.accept(measurement, observation);
  if (observation.evidence == ObjectEvidence::shape) {
    observation.covariance += measurement.camera_covariance;
  }
  return observation;
}

}  // namespace pcavr
