// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"
#include "pcavr/geometry/tracked_pose.hpp"
#include "pcavr/object/object_parameters.hpp"
#include "pcavr/prediction/body_physics.hpp"
#include "pcavr/prediction/predicted_world.hpp"

namespace pcavr {

class CorrectionTrial;

/// How a contact went so far, as it was measured.
struct RecordedContact {
  std::size_t object = 0;
  double begin = 0.0, end = 0.0;                              ///< [s]
  Pose T_base_start;                                          ///< of the object at the begin
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitX();  ///< of the push
  std::vector<TrackedPose> seen;                      ///< of the object, on the tool's clock
  std::vector<double> t_force;                        ///< [s]
  std::vector<Eigen::Vector3d> force_base;            ///< [N] on the object
  double force_resolution = 0.0;                      ///< [N] below it no difference counts
  std::function<Eigen::Vector3d(double)> p_base_tip;  ///< at any time [s]
};

/// The prediction of a recorded contact with some parameters, which can be interrupted after any
/// step.
struct ContactRun {
  std::shared_ptr<const RecordedContact> contact;
  BodyPhysics physics;
  std::vector<BodyState> state = {};  ///< of the world; empty: not begun
  std::size_t step = 0;               ///< the last one
  std::size_t next_seen = 0, next_force = 0;
  double position_squares = 0.0;  ///< [m^2] of the errors along the push
  double force_squares = 0.0;     ///< [N^2]
};

/// Errors of contacts that were predicted before: those of the last ones are needed again and
/// again, as both sites' parameters change seldom.
class KnownContactErrors {
 public:
  [[nodiscard]] std::optional<double> find(const RecordedContact& contact,
                                           const BodyPhysics& physics) const;
  void add(const ContactRun& run, double error);
  /// The samples were put on another clock.
  void clear() { known_.clear(); }

 private:
  struct Known {
    double begin, end;
    BodyPhysics physics;
    double error;
  };
  std::deque<Known> known_;  ///< the newest
};

/// A trial of parameters before they are sent: each of the last contacts is predicted with those
/// that the operator's site has and with these. Some steps at a time, because the robot's cycle
/// must not wait for it.
class ParameterTrial {
 public:
  enum class Verdict : std::uint8_t { undecided, good, worse };
  struct Contact {
    std::shared_ptr<const RecordedContact> recorded;
    BodyPhysics before, after;
  };

  ParameterTrial(ObjectParameters parameters, std::vector<Contact> contacts)
      : parameters_(std::move(parameters)), contacts_(std::move(contacts)) {}

  /// Goes on by at most `steps` steps of the prediction, which are taken from it.
  void advance(CorrectionTrial& trial, KnownContactErrors& known, std::size_t& steps);
  [[nodiscard]] Verdict verdict() const { return verdict_; }
  [[nodiscard]] const ObjectParameters& parameters() const { return parameters_; }

 private:
  /// The error with `physics`; empty: more steps are needed.
  [[nodiscard]] std::optional<double> error_with(const BodyPhysics& physics, CorrectionTrial& trial,
                                                 KnownContactErrors& known, std::size_t& steps);

  ObjectParameters parameters_;
  std::vector<Contact> contacts_;
  std::size_t next_ = 0;               ///< contact
  std::optional<double> before_ = {};  ///< its error with the parameters before
  std::optional<ContactRun> run_ = {};
  Verdict verdict_ = Verdict::undecided;
};

}  // namespace pcavr
