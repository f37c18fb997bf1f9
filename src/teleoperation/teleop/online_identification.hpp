// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/turning/body_motion.hpp"
#include "pcavr/physics/turning/turning.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

#include "teleoperation/teleop/friction_search.hpp"

namespace pcavr {

/// The object in a contact, by tracking.
struct ObjectMotion {
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
  std::optional<ObjectMotion> seen = {};
};

/// Online identification of one object's parameters, contact by contact, with the methods of
/// `pcavr identify`: the contact law from presses, or without any from pushes while the object is
/// static; F_M, M, mu and B from the pushes so far, as `identify_friction_of` finds them; where the
/// object is tracked, the friction radius and limit surface from its turning, and the tip's
/// friction from its slip along a face. Parameters without excitation keep their values.
///
/// An estimate replaces a previous one that was based on less data, or that the data contradict: by
/// more than some standard deviations and a model error. So noise does not degrade given
/// parameters, but wrong ones are corrected.
class OnlineIdentification {
 public:
  /// Each contact with an object that is not movable is a press, in whatever direction.
  explicit OnlineIdentification(const ObjectParameters& given, const LearningOptions& options = {},
                                bool is_movable = true);

  /// Facts about a contact beside its force and motion.
  struct ContactFacts {
    bool has_slid = false;   ///< by force and motion
    bool has_moved = false;  ///< by tracking
    bool is_over = false;
  };
  /// Identifies from a contact that began at `begin` [s], again if it was processed before. A
  /// contact in which the object has not slid yet has no information on friction: a tool that stops
  /// looks like a breakaway. A push that moved the object although no slide was found in it has
  /// none at all: a slow slide looks like a soft contact; nor one along an inclined face. True if a
  /// parameter has changed: of the contact, or by tracking. Friction follows by `next_search`.
  bool learn(const ContactRecord& record, double begin, const ContactFacts& facts);

  /// The next search for the friction of the pushes so far, if one was added since the last search.
  /// The bodies in the records must outlive it.
  [[nodiscard]] std::optional<FrictionSearch> next_search();
  /// Accepts what a search has found in the pushes up to then. True if a parameter has changed.
  bool accept(const FrictionSearch::Findings& findings);

  /// [N] at which the sensor saturates: contacts that reach it are not used.
  void set_force_ceiling(std::optional<double> ceiling) { force_ceiling_ = ceiling; }

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
  /// A new estimate from more data replaces a learned one up to this ratio of their stds.
  static constexpr double kMaxStdRatio = 1.2;

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
  /// The newest contact, along the touched face where the object is tracked.
  [[nodiscard]] IdentifiedContact attributed(const ContactRecord& record,
                                             const Segmentation& found) const;
  /// Discards F_M, and the push's breakaway, where they are below what the push slides under.
  void check_limits(IdentifiedContact& push);
  void store_push(const ContactRecord& record, IdentifiedContact contact);
  /// Assumes mu and B by the push's own slides and the prior of B, until a search has found them.
  void assume_friction(const ContactEpisode& push);
  /// Assumes F_M by the prior of its excess over Coulomb friction [N], until a search has found it:
  /// pushes off the centre do not show it.
  void assume_limit(double coulomb);
  void accept_limit(const ObjectIdentification& found);
  /// Whether the force under which the newest push slid contradicts the known sliding friction;
  /// `mass` [kg].
  [[nodiscard]] bool is_sliding_contradicted(const std::vector<FrictionSample>& samples,
                                             double mass) const;
  /// Accepts mu and B together: only both give the friction at the speeds of the pushes. True if
  /// accepted.
  bool accept_sliding(const ObjectIdentification& found);
  /// A new mass beside a coefficient that is kept would change the friction force that both were
  /// identified from.
  void keep_friction_force(const std::optional<ParameterValue>& mass_before);
  void discard_learned_limit();
  /// Learns from the newest contact and those before it. The radius is learnt from many contacts
  /// once one `is_over`: it takes tens of milliseconds.
  void learn_turning(const ContactRecord& record, const IdentifiedContact& contact, bool is_over);
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
  std::optional<double> conservative_limit_;  ///< [N]
  std::optional<std::string> contradiction_;
  std::vector<ContactEpisode> contacts_;
  std::deque<FrictionSearch::Push> pushes_;
  bool has_new_push_ = false;        ///< since the last search
  const CadModel* model_ = nullptr;  ///< of a tracked object
  double tool_radius_ = 0.0;         ///< [m]
  ContactIdentification presses_;  ///< the newest that fit; the law may be too uncertain to be felt
  double penetration_std_ = 0.0;   ///< relative, by the learned contact law
  bool is_friction_assumed_ = false, is_limit_assumed_ = false;
  double sliding_force_std_ = 0.0;  ///< relative, of the learned mu and B
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
