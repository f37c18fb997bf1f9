// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pcavr/pipeline/identify.hpp"

#include "identify_signals.hpp"

namespace pcavr {

/// The parts of identify(), each one idea.

/// Where the objects are over time: by tracking, else by how far earlier pushes moved them.
class ObjectPlaces {
 public:
  explicit ObjectPlaces(const std::vector<IdentifiableObject>& objects);

  [[nodiscard]] Pose at(std::size_t object, double t) const;
  [[nodiscard]] bool is_tracked(std::size_t object) const;
  /// A push took the object along; only where it is not tracked.
  void moved(std::size_t object, double t, const Eigen::Vector3d& way_base);

  struct Touch {
    double gap = 0.0;  ///< [m] between tip and surface, negative inside
    Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
    /// Unit, from the tip's centre to the nearest place on the surface: into the body, and at an
    /// edge, where faces have two normals, right between.
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

/// How far the object has gone in this contact [m] at `t` [s], along its direction: the tip's way
/// less the contact's give, over the slides.
[[nodiscard]] double way_at(const ContactEpisode& episode, double t);

/// A stretch of time in which force or tool are not to be trusted.
struct BadStretch {
  SlideInterval when;
  std::string reason;
};
/// Whose contact each one is, along which direction, and which ones tell nothing.
[[nodiscard]] std::vector<IdentifiedContact> attribute_contacts(
    const IdentificationInput& input, const Segmentation& found, std::span<const double> t_force,
    const PathView& tip, const std::vector<BadStretch>& bad, ObjectPlaces& places);

/// The contacts of one kind that belong to an object and may be learnt from.
[[nodiscard]] std::vector<IdentifiedContact*> contacts_of(std::vector<IdentifiedContact>& contacts,
                                                          std::size_t object, bool presses);

/// Presses, faces and impacts, and the estimators' comparison.
void identify_contact_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                         ObjectIdentification& result);
/// `found` of these presses.
[[nodiscard]] std::vector<EstimatorTrace> compare_estimators(std::span<const ForceMotion> presses,
                                                             const ContactIdentification& found);
void identify_impacts(const std::vector<IdentifiedContact*>& pushes, ObjectIdentification& result);

/// Breakaway and sliding.
void identify_friction_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                          std::optional<double> weighed, ObjectIdentification& result);
/// Pushes that turn the object; needs tracking.
void identify_turning_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                         const IdentifiableObject& body, const PathView& tip, double tool_radius,
                         ObjectIdentification& result);

[[nodiscard]] ParameterValue as_value(const IdentifiedParameter& parameter);

/// How much later the tracked poses are than the tool: while the object slides it keeps with it.
[[nodiscard]] TimeOffset camera_offset(const IdentificationInput& input,
                                       const std::vector<IdentifiedContact>& contacts);

}  // namespace pcavr
