// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/identification/segmentation.hpp"

namespace pcavr {

/// What a site has recorded about a contact up to now, with some free time before it.
struct ContactRecord {
  std::span<const double> t_force;
  std::span<const Eigen::Vector3d> force_base;
  std::span<const double> t_tool;
  std::span<const Eigen::Vector3d> p_base_tip;
};

/// The robot's knowledge of one object, learned contact by contact with the procedures of
/// identification: the contact's law from presses, or where there were none from what pushes show
/// while the object stands; F_M from each breakaway; M, mu and B from sliding. What the motion did
/// not excite stays as it was.
///
/// A number replaces another where the older one was learned from less, or where the data
/// contradict it: by more than four deviations and 5 %. So what was given beforehand is not worn
/// away by noise, and a wrong file is found out.
class ObjectLearner {
 public:
  /// `force_ceiling` [N]: at which the sensor saturates; contacts that reach it teach nothing.
  ObjectLearner(const ObjectParameters& given, std::optional<double> force_ceiling);

  /// Looks at a contact that began at `begin` [s], again if it has been shown before. A contact in
  /// which the object has not slid yet tells nothing of friction: a tool that stops looks like a
  /// breakaway that goes flat. True where something was learned.
  bool learn(const ContactRecord& record, double begin, bool has_slid);

  /// The object stood still under `friction` [N], where its physics let it go: what was said of its
  /// friction is not true, and is forgotten. Until it breaks away it counts as rougher by half than
  /// what it has withstood.
  void withstand(double friction);

  [[nodiscard]] const ObjectParameters& known() const { return known_; }
  /// With what stands in for F_M until a breakaway is seen.
  [[nodiscard]] ObjectParameters supposed() const;

 private:
  void learn_contact();
  void learn_breakaway();
  void learn_sliding();
  void accept(std::optional<ParameterValue> ObjectParameters::*field, const ParameterValue& found);
  [[nodiscard]] bool is_contradicted(const std::optional<ParameterValue>& old,
                                     const ParameterValue& found) const;

  ObjectParameters known_;
  ObjectParameters given_;
  std::optional<double> force_ceiling_;
  std::optional<double> supposed_limit_;  ///< [N]
  std::vector<ContactEpisode> contacts_;
  bool has_changed_ = false;
};

}  // namespace pcavr
