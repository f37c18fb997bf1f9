// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/identification/segmentation.hpp"

namespace pcavr {

/// A body that the tool may touch. Refers to its model and series, which must outlive it.
struct InputBody {
  std::string name;
  const CadModel* model = nullptr;
  Pose T_base_object;                         ///< at the start
  std::optional<double> mass = {};            ///< [kg] where it was weighed
  std::span<const TrackedPose> tracked = {};  ///< may be empty: its motion follows from the pushes
  bool is_movable = true;                     ///< false: it stays at T_base_object
};

/// The measured series of one recording, or of a part of it, on one clock: base frame, SI, stamps
/// ascending strictly. A view: what it refers to must outlive it.
struct InputSeries {
  std::vector<InputBody> bodies = {};
  double tool_radius = 0.01;  ///< [m] of the spherical tip
  std::span<const double> t_tool = {};
  std::span<const Eigen::Vector3d> p_base_tip = {};
  /// The tool's orientations at `t_tool`. May be empty: then a force in the tool's axes is not
  /// recognised as such.
  std::span<const Eigen::Quaterniond> q_base_tool = {};
  std::span<const double> t_force = {};
  std::span<const Eigen::Vector3d> force_base = {};  ///< that the tool exerts [N]
};

/// One contact and the body that it belongs to.
struct AttributedContact {
  ContactEpisode episode;                        ///< series along `episode.direction_base`
  std::optional<std::size_t> object = {};        ///< index of the body
  std::vector<Eigen::Vector3d> force_base = {};  ///< [N] at the stamps of `episode.t`
  std::string left_out = {};                     ///< why it is not usable; empty where it is
  double gap = 0.0;  ///< [m] between tip and the object's surface at touch
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();  ///< of the face touched, outward
  double lever = 0.0;  ///< [m] signed lever arm of the force about the centre of mass, in the plane
};

/// The object's displacement in this contact [m] at `t` [s], along its direction: the tip's
/// displacement less the contact's compression, over the slides.
[[nodiscard]] double displacement_at(const ContactEpisode& episode, double t);

}  // namespace pcavr
