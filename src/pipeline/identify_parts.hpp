// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pcavr/pipeline/identify.hpp"

#include "identify_signals.hpp"

namespace pcavr {

/// The steps of identify().

/// The objects' poses over time: by tracking, else by the displacements of earlier pushes.
class ObjectPoses {
 public:
  explicit ObjectPoses(const std::vector<IdentifiableObject>& objects);

  [[nodiscard]] Pose at(std::size_t object, double t) const;
  [[nodiscard]] bool is_tracked(std::size_t object) const;
  /// Adds the displacement by a push; only for an object that is not tracked.
  void displace(std::size_t object, double t, const Eigen::Vector3d& displacement_base);

  struct Touch {
    double gap = 0.0;  ///< [m] between tip and surface, negative inside
    Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
    /// Unit, from the tip's centre to the closest point of the surface: into the body; at an edge,
    /// between the two faces' normals.
    Eigen::Vector3d inward_base = Eigen::Vector3d::Zero();
  };
  /// Nothing where the surface is farther than 0.2 m.
  [[nodiscard]] std::optional<Touch> touch(std::size_t object, double t,
                                           const Eigen::Vector3d& p_base_tip,
                                           double tool_radius) const;

 private:
  struct Step {
    double t;
    Eigen::Vector3d total_base;
  };
  const std::vector<IdentifiableObject>& objects_;
  std::vector<SurfaceQuery> surfaces_;
  std::vector<std::vector<Step>> steps_;
};

/// The object's displacement in this contact [m] at `t` [s], along its direction: the tip's
/// displacement less the contact's compression, over the slides.
[[nodiscard]] double displacement_at(const ContactEpisode& episode, double t);

/// A time interval in which force or tool motion are invalid.
struct BadInterval {
  SlideInterval when;
  std::string reason;
};
/// Attributes each contact to an object and a direction, and excludes unusable ones.
[[nodiscard]] std::vector<IdentifiedContact> attribute_contacts(
    const IdentificationInput& input, const Segmentation& found, std::span<const double> t_force,
    const PathView& tip, const std::vector<BadInterval>& bad, ObjectPoses& object_poses);

/// The usable contacts of one kind (presses or pushes) with an object.
[[nodiscard]] std::vector<IdentifiedContact*> contacts_of(std::vector<IdentifiedContact>& contacts,
                                                          std::size_t object, bool presses);

/// Presses, faces and impacts, and the estimators' comparison.
void identify_contact_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                         ObjectIdentification& result);
/// `found` is the identification from these presses.
[[nodiscard]] std::vector<EstimatorTrace> compare_estimators(std::span<const ForceMotion> presses,
                                                             const ContactIdentification& found);
void identify_impacts(const std::vector<IdentifiedContact*>& pushes, ObjectIdentification& result);

/// Breakaway and sliding.
void identify_friction_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                          std::optional<double> given_mass, ObjectIdentification& result);
/// Pushes that turn the object; needs tracking.
void identify_turning_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                         const IdentifiableObject& body, const PathView& tip, double tool_radius,
                         ObjectIdentification& result);

[[nodiscard]] ParameterValue as_value(const IdentifiedParameter& parameter);

/// Delay of the tracked poses against the tool, from slides: there the object moves with the tip.
[[nodiscard]] TimeOffset camera_offset(const IdentificationInput& input,
                                       const std::vector<IdentifiedContact>& contacts);

}  // namespace pcavr
