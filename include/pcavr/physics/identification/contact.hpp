// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/identification/press_line.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

enum class ContactKind {
  press,  ///< mostly along z, against the support
  push,   ///< along the plane; the object stayed at rest
  slide   ///< along the plane; the object broke loose and slid
};

/// An interval in which the object slid.
struct SlideInterval {
  double begin = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
};

/// A contact so short that the tool's motion before and after it shows the restitution: an impact.
/// Along the contact's direction, in which the tool pushes.
struct ImpactMotion {
  IdentifiedParameter approach;    ///< [m/s] speed of the tool before, > 0
  IdentifiedParameter separation;  ///< [m/s] of the tool after, backwards; < 0: it moves on
  /// separation / approach, with their correlation in its std.
  IdentifiedParameter speed_ratio;
  IdentifiedParameter mass;   ///< [kg] effective, of the tool: impulse over change of speed
  double impulse = 0.0;       ///< [N s] > 0
  double width = 0.0;         ///< [s] std of the force's distribution over time
  double width_std = 0.0;     ///< [s] of `width`, by the force's noise
  double sample_width = 0.0;  ///< [s] the part of `width` that is due to the sensor's averaging
};

/// One contact of the tool with an object, from first touch to separation. Segmentation makes it
/// from force and motion, attribution finds the object and the face that were touched, and the
/// identification of the object adds what the contact showed. Stamps [s] on the tool's clock, base
/// frame.
struct Contact {
  // By segmentation.
  ContactKind kind = ContactKind::push;
  double begin = 0.0;                                        ///< [s] extrapolated to the surface
  double end = 0.0;                                          ///< [s] likewise
  Eigen::Vector3d direction_base = Eigen::Vector3d::Zero();  ///< unit, of the mean force
  double peak_force = 0.0;                                   ///< [N] smoothed
  Breakaway breakaway = {};                                  ///< pushes and slides only
  std::vector<SlideInterval> slides = {};
  /// An impact's begin and end are where the force passes its threshold; of the fields above it has
  /// no breakaway and no slides.
  std::optional<ImpactMotion> impact = {};
  /// The series at the force's timestamps, with some free time before and after: tool and force
  /// along `direction_base`, and the whole force [N]. Bias and drift are removed.
  std::vector<double> t = {}, tool = {}, force = {};
  std::vector<Eigen::Vector3d> force_base = {};
  std::optional<double> tool_noise = {};  ///< [m] std of `tool`, from the tip's own samples
  std::optional<double> tip_noise = {};   ///< [m] of these: interpolation averages two of them

  // By attribution.
  std::optional<std::size_t> object = {};  ///< index of the body
  std::string left_out = {};               ///< why it is not usable; empty where it is
  double gap = 0.0;                        ///< [m] between tip and the object's surface at touch
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();  ///< of the face touched, outward
  double lever = 0.0;  ///< [m] signed lever arm of the force about the centre of mass, in the plane
  Pose T_base_object;  ///< at touch

  // What identification needs beside it, at any time: the tip's path and the object's poses, which
  // do not overlap those of the contact before.
  std::vector<double> t_tool = {};
  std::vector<Eigen::Vector3d> p_base_tip = {};
  std::vector<TrackedPose> tracked = {};
  /// [m] std of `tool` by a cause that all samples share; empty: none.
  std::vector<double> tip_std = {};

  // By identification.
  IdentifiedParameter limit = {};  ///< [N] friction limit, less inertia where possible
  double limit_shared_std = 0.0;   ///< [N] ... and its std that the object's pushes have in common
  double breakaway_lever = 0.0;    ///< [m] of the force then; 0 where the object was not tracked
  double breakaway_turning = 0.0;  ///< [rad/m] of the object's first travel; 0 likewise
  /// The line of a push, where a press gave the object's contact law; its ratio may be not excited.
  std::optional<PressLine> press_line = {};

  [[nodiscard]] ForceMotion series() const { return {t, tool, force, tool_noise}; }
};

/// The contact with `delay` [s] added to all its stamps.
[[nodiscard]] Contact delayed(Contact contact, double delay);

/// The object's displacement in this contact [m] at `t` [s], along its direction: the tip's
/// displacement less the contact's compression, over the slides.
[[nodiscard]] double displacement_at(const Contact& contact, double t);

}  // namespace pcavr
