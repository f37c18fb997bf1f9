// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

namespace pcavr {

/// Facts about a contact beside its force and motion.
struct ContactFacts {
  bool has_slid = false;   ///< by force and motion
  bool has_moved = false;  ///< by tracking
};

/// The samples of a contact up to now, with some time without contact before it, to be segmented.
/// Stamps [s] on the tool's clock.
struct ContactSamples {
  std::vector<double> t_force;
  std::vector<Eigen::Vector3d> force_base;  ///< [N]
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;  ///< [m]
  std::vector<TrackedPose> tracked = {};    ///< the object's poses; empty: not tracked
  double begin = 0.0;                       ///< [s] of the contact
  ContactFacts facts = {};
};

/// Online identification of one object's parameters, contact by contact. Every value is a result of
/// `ObjectIdentifier`, which `pcavr identify` uses, on the newest `max_fitted_contacts` presses and
/// as many pushes; only when it is computed, and whether it is good enough to be used, is decided
/// here. Meanwhile preliminary values are used: the linear law of a press whose force has not risen
/// far, the friction of a push's own slides. Parameters without excitation keep their values.
///
/// A value replaces a previous one that was based on less data, or that the data contradict: by
/// more than some standard deviations and a model error. So noise does not degrade given
/// parameters, but wrong ones are corrected. Not thread-safe; copies are cheap.
class OnlineIdentification {
 public:
  /// Its mass and poses are not used: `given` has what is known. `tool_radius` [m].
  OnlineIdentification(std::shared_ptr<const IdentifiableObject> object,
                       const ObjectParameters& given, double tool_radius,
                       const LearningOptions& options = {});

  /// Adds a contact, in place of the last one if that began at the same time. A contact in which
  /// the object has not slid yet has no information on friction: a tool that stops looks like a
  /// breakaway. A push that moved the object although no slide was found in it has none at all: a
  /// slow slide looks like a soft contact; nor one along an inclined face. True if the contact law
  /// has changed, or a preliminary value. Friction follows by `next_search`.
  bool learn(const ContactSamples& samples);
  bool add(std::shared_ptr<const Contact> contact, bool has_slid);

  /// Identification of all parameters from the contacts so far, if it would find another result
  /// than the last. Its object must outlive it.
  [[nodiscard]] std::optional<ObjectIdentifier> next_search();
  /// Uses what a search has found in the contacts up to then. True if a parameter has changed.
  bool accept(const ObjectIdentifier::Result& result);

  /// [N] at which the sensor saturates: contacts that reach it are not used.
  void set_force_ceiling(std::optional<double> ceiling) { force_ceiling_ = ceiling; }
  /// See InputFindings::suspected_turn [rad].
  void set_suspected_turn(double angle);

  /// The object was static at `friction` [N], beyond its supposed limit F_M: discards its friction
  /// parameters, unless breakaways have identified them here. Until the next breakaway, F_M is that
  /// force times `static_limit_factor`.
  void raise_static_limit(double friction);

  /// Why the limiting friction that the breakaways up to the last contact show is not used, if so.
  [[nodiscard]] const std::optional<std::string>& contradiction() const { return contradiction_; }

  [[nodiscard]] const ObjectParameters& known() const { return known_; }
  /// The known parameters, with a conservative F_M until a breakaway is observed.
  [[nodiscard]] ObjectParameters conservative_estimate() const;
  [[nodiscard]] const std::deque<std::shared_ptr<const Contact>>& contacts() const {
    return contacts_;
  }

 private:
  /// A result from more data replaces a learned one up to this ratio of their stds.
  static constexpr double kMaxStdRatio = 1.2;

  [[nodiscard]] bool is_press(const Contact& contact) const;
  [[nodiscard]] bool is_usable(const Contact& contact, const ContactSamples& samples) const;
  /// [s] End of the path of the contacts before one that begins at `begin` [s].
  [[nodiscard]] double path_end_before(double begin) const;
  /// The contact along the touched face, where the object is tracked.
  [[nodiscard]] std::shared_ptr<const Contact> along_face(const ContactSamples& samples,
                                                          Contact&& contact) const;
  /// In place of an earlier state of the same contact.
  void store(std::shared_ptr<const Contact> contact, bool has_slid);
  void forget_old_contacts();
  /// The identification from the contacts so far.
  [[nodiscard]] ObjectIdentifier identifier(const ObjectParameters& known,
                                            IdentificationGoal goal) const;
  /// The contact law: of the presses, which pushes do not change, or else of the pushes.
  [[nodiscard]] ObjectIdentification identify_law() const;
  void learn_contact();
  /// Relative std of the penetration by a law; empty where it may not be used. `max_force` [N]: of
  /// the contacts that gave it.
  [[nodiscard]] std::optional<double> usable_std(const ContactFit& fit, bool is_of_face,
                                                 double max_force) const;
  [[nodiscard]] bool is_given_law_confirmed(const HuntCrossley& law, double relative_std) const;
  /// Assumes mu and B by the push's own slides and the prior of B, until a search has found them.
  void assume_friction(const Contact& push);
  /// Assumes F_M by the prior of its excess over Coulomb friction [N], until a search has found it:
  /// pushes off the centre do not show it.
  void assume_limit(double coulomb);
  /// A breakaway below what the push then slides under is no breakaway, but the load of a tip that
  /// slipped, or left and came again, before the object slides at all. Discards a learned F_M, too,
  /// that is below it.
  void check_breakaway(Contact& push);
  void note_contradiction(double limit, double sliding);  ///< [N]
  void accept_limit(const ObjectIdentification& found);
  /// Whether the force under which the newest push slid contradicts the known sliding friction;
  /// `mass` [kg].
  [[nodiscard]] bool is_sliding_contradicted(const std::vector<FrictionSample>& samples,
                                             double mass) const;
  /// Accepts mass, mu and B together: only all three give the friction at the speeds of the pushes.
  void accept_sliding(const ObjectIdentification& found);
  void accept_radius(const ObjectIdentification& found);
  /// The object as it was first tracked in the contacts: the face that it stands on.
  [[nodiscard]] Pose first_pose() const;
  void accept_tool_friction(const ObjectIdentification& found);
  void discard_learned_limit();
  bool accept(std::optional<ParameterValue> ObjectParameters::*field, const ParameterValue& found);
  [[nodiscard]] bool is_contradicted(const std::optional<ParameterValue>& old,
                                     const ParameterValue& found) const;

  LearningOptions options_;
  std::shared_ptr<const IdentifiableObject> object_;
  ObjectIdentifier identifier_;  ///< without contacts
  double tool_radius_;           ///< [m]
  ObjectParameters known_;
  ObjectParameters given_;  ///< less what was contradicted
  std::optional<double> force_ceiling_;
  std::optional<double> conservative_limit_;  ///< [N]
  std::optional<std::string> contradiction_;
  std::deque<std::shared_ptr<const Contact>> contacts_;
  bool has_slid_ = false;  ///< in any contact
  bool is_law_of_presses_ = false;
  bool is_search_due_ = false;   ///< the contacts or the suspected turn have changed since the last
  double suspected_turn_ = 0.0;  ///< [rad]
  bool is_friction_assumed_ = false, is_limit_assumed_ = false;
  double sliding_force_std_ = 0.0;  ///< relative, of the learned mu and B
  bool has_changed_ = false;
};

}  // namespace pcavr
