// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

class ContactFits;

enum class IdentificationGoal {
  contact,  ///< contact law: stiffness, damping, exponent
  friction  ///< breakaway, sliding and turning friction; with the contact law that these need
};

/// A body that the tool may have touched.
struct IdentifiableObject {
  std::string name;
  CadModel model;
  Pose T_base_object;                     ///< pose at the start
  std::optional<double> mass = {};        ///< [kg] where it was weighed
  std::vector<TrackedPose> tracked = {};  ///< may be empty: then its motion follows from the pushes
  /// False: every contact is a press, whatever its direction, and only the contact law is
  /// identified.
  bool is_movable = true;
};

/// Identifies one object's parameters from its contacts: contact law, friction, turning, with their
/// standard deviations, and what the motion does not show. Contacts may be added in any order: the
/// same contacts give the same result, to the last digit. Not thread-safe; copies are cheap, as
/// they share the contacts.
class ObjectIdentifier {
 public:
  /// `known`: identified earlier; new results replace it. `tool_radius` [m] of the spherical tip.
  /// Keeps a reference to `object`, which must outlive it.
  ObjectIdentifier(const IdentifiableObject& object, ObjectParameters known, double tool_radius,
                   IdentificationGoal goal, const IdentificationOptions& options);

  /// The same contacts with the same object, where something else is known or asked for.
  [[nodiscard]] ObjectIdentifier with(ObjectParameters known, IdentificationGoal goal) const;

  void add(std::shared_ptr<const Contact> contact);
  [[nodiscard]] std::size_t size() const { return contacts_.size(); }
  [[nodiscard]] const BodySurface& surface() const { return *surface_; }

  /// See InputFindings::suspected_turn [rad].
  void set_suspected_turn(double angle) { suspected_turn_ = angle; }

  struct Result {
    ObjectIdentification object;
    std::vector<Contact> contacts;  ///< in order of time, with what each showed
  };
  [[nodiscard]] Result result() const;

 private:
  const IdentifiableObject* object_;
  std::shared_ptr<const BodySurface> surface_;
  ObjectParameters known_;
  double tool_radius_;  ///< [m]
  IdentificationGoal goal_;
  IdentificationOptions options_;
  std::shared_ptr<ContactFits> contact_fits_;             ///< of `options_`
  double suspected_turn_ = 0.0;                           ///< [rad]
  std::vector<std::shared_ptr<const Contact>> contacts_;  ///< by their begin
};

}  // namespace pcavr
