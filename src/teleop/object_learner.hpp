// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/contact/hunt_crossley.hpp"
#include "pcavr/identification/contact_fit.hpp"
#include "pcavr/identification/parameter.hpp"
#include "pcavr/identification/segmentation.hpp"
#include "pcavr/inputs/touch.hpp"
#include "pcavr/object/object_parameters.hpp"
#include "pcavr/teleop/options.hpp"
#include "pcavr/turning/body_motion.hpp"
#include "pcavr/turning/turning.hpp"

namespace pcavr {

/// The object in a contact, by tracking.
struct SeenMotion {
  BodyMotion body;  ///< at least one pose
  const BodySurface& surface;
  double tool_radius = 0.0;  ///< [m]
};

/// The data of a contact up to now, with some time without contact before it.
struct ContactRecord {
  std::span<const double> t_force;
  std::span<const Eigen::Vector3d> force_base;
  std::span<const double> t_tool;
  std::span<const Eigen::Vector3d> p_base_tip;
  std::optional<SeenMotion> seen = {};
};

/// Online identification of one object's parameters, contact by contact, with the methods of
/// `identification`: the contact law from presses, or without any from pushes while the object is
/// static; F_M from each breakaway; M, mu and B from sliding; where the object is tracked, the
/// friction radius and limit surface from its turning, and the tip's friction from its slip along a
/// face. Parameters without excitation keep their values.
///
/// An estimate replaces a previous one that was based on less data, or that the data contradict: by
/// more than some standard deviations and a model error. So noise does not degrade given
/// parameters, but wrong ones are corrected.
class ObjectLearner {
 public:
  /// Each contact with an object that is not movable is a press, in whatever direction.
  explicit ObjectLearner(const ObjectParameters& given, const LearningOptions& options = {},
                         bool is_movable = true);

  /// What is known of a contact beside its force and motion.
  struct ContactFacts {
    bool has_slid = false;   ///< by force and motion
    bool has_moved = false;  ///< by tracking
    bool is_over = false;
  };
  /// Identifies from a contact that began at `begin` [s], again if it was processed before. A
  /// contact in which the object has not slid yet has no information on friction: a tool that stops
  /// looks like a breakaway. A push that moved the object although no slide was found in it has
  /// none at all: a slow slide looks like a soft contact; nor one along an inclined face. True if a
  /// parameter has changed.
  bool learn(const ContactRecord& record, double begin, const ContactFacts& facts);

  /// [N] at which the sensor saturates: contacts that reach it are not used.
  void set_force_ceiling(std::optional<double> ceiling) { force_ceiling_ = ceiling; }

  /// By which the slides are identified until the contact law is.
  void set_assumed_law(const HuntCrossley& law) { assumed_law_ = law; }

  /// The object was static at `friction` [N], beyond its supposed limit F_M: discards its friction
  /// parameters, unless breakaways have identified them here. Until the next breakaway, F_M is that
  /// force times `static_limit_factor`.
  void raise_static_limit(double friction);

  /// Why the limiting friction that the breakaways up to the last contact show is not used, if so.
  [[nodiscard]] const std::optional<std::string>& contradiction() const { return contradiction_; }

  [[nodiscard]] const ObjectParameters& known() const { return known_; }
  /// The known parameters, with a conservative F_M until a breakaway is observed.
  [[nodiscard]] ObjectParameters conservative_estimate() const;

 private:
  /// [s] The estimated start of a new contact may still change by this much with more data.
  static constexpr double kSameContact = 0.25;

  [[nodiscard]] bool is_press(const ContactEpisode& contact) const;
  /// Gives a press the direction of an earlier one on the same face, so that both meet the surface
  /// at the same coordinate: at half a metre from base, 0.05 degrees would displace it by 0.4 mm.
  void align_press(const ContactRecord& record, ContactEpisode& press) const;
  /// Relative std of the penetration at F_M beyond that of the fit, where the fitted contacts have
  /// not reached that force: a law of the first newtons says little about the tenfold.
  [[nodiscard]] double extrapolation_std(const ContactFit& fit,
                                         std::span<const ForceMotion> parts) const;
  /// Relative std of the penetration by a law; empty where it may not be used.
  [[nodiscard]] std::optional<double> usable_std(const ContactFit& fit,
                                                 std::span<const ForceMotion> parts) const;
  void learn_contact();
  /// F_M of the breakaways, with what the slides say of it by the rule of `pcavr identify`: no less
  /// than Coulomb friction, and withheld where the two contradict each other.
  void learn_breakaway();
  /// Discards an F_M that was identified before the slides contradicted it.
  void withdraw_limit_below(const IdentifiedParameter& sliding);
  void discard_learned_limit();
  void contradict(double limit, double sliding);
  void learn_sliding();
  /// By the newest contact, and those before it. The radius of many once a contact `is_over`: it
  /// takes tens of milliseconds.
  void learn_turning(const ContactRecord& record, const Segmentation& found, bool is_over);
  void learn_tool_friction(std::span<const TrackedPose> tracked);
  void learn_radius(const BodyMotion& body);
  bool accept(std::optional<ParameterValue> ObjectParameters::*field, const ParameterValue& found);
  [[nodiscard]] bool is_contradicted(const std::optional<ParameterValue>& old,
                                     const ParameterValue& found) const;

  LearningOptions options_;
  bool is_movable_;
  ObjectParameters known_;
  ObjectParameters given_;
  std::optional<double> force_ceiling_;
  std::optional<HuntCrossley> assumed_law_;
  std::optional<double> conservative_limit_;  ///< [N]
  IdentifiedParameter coulomb_;               ///< [N] of the slides so far
  std::optional<std::string> contradiction_;
  std::vector<ContactEpisode> contacts_;
  /// What tracking shows in a contact.
  struct SeenSamples {
    double begin = 0.0;  ///< [s]
    std::vector<PushSample> turning;
    std::vector<double> tool_friction;
  };
  std::deque<SeenSamples> seen_samples_;
  bool has_changed_ = false;
};

}  // namespace pcavr
