// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/contact.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct SegmentationOptions {
  SegmentationOptions();
  double half_width;       ///< [s] of the force's smoothing
  double enter_threshold;  ///< smoothed force: contact begins above this many stds, ...
  double min_force;        ///< [N] ... and above this (drift not yet estimated)
  double leave_share;      ///< of that threshold: contact ends below (hysteresis)
  double min_duration;     ///< [s] shorter touches are disturbances; shorter gaps are closed
  double margin;           ///< [s] of free time kept around a contact
  double free_time;        ///< [s] next to a contact that the fit of its begin and end uses
  double bias_half_width;  ///< [s] of the moving mean of the free force, which is its drift
  double max_drift;        ///< [N/s] of the sensor's bias, where its contacts are not yet known
  /// Largest change of the bias with the tip's place [N/m], as a cable pulls on the sensor.
  double max_cable_stiffness;
  double max_impact;        ///< [s] longer contacts are no impacts
  double impact_flight;     ///< [s] before and after an impact, in which the tool flies freely
  double slide_half_width;  ///< [s] of the smoothing of the object's speed
  double slide_speed;       ///< [m/s] above this, and above the noise: sliding
  SpikeOptions spikes;      ///< of the force
  BreakawayOptions breakaway;
};
/// The options without those of `spikes` and `breakaway`, which have their own sections.
[[nodiscard]] OptionSection section_of(SegmentationOptions& options);

struct Segmentation {
  std::vector<Contact> contacts;            ///< by time; between them the tool is free
  std::vector<Eigen::Vector3d> force_base;  ///< [N] despiked, bias and drift removed, per stamp
  std::vector<Eigen::Vector3d> bias_base;   ///< [N] what was subtracted
  std::size_t spikes = 0;                   ///< single samples replaced, all axes
  double noise = 0.0;                       ///< [N] of one raw sample, largest axis
};

/// Finds every contact of a recording without annotations: contact-free intervals by the force at
/// rest about its own slowly drifting bias, then press or push by direction, then sliding by
/// breakaway and by the speed of tool less penetration. Force that the tool exerts, at `t_force`;
/// tip at `t_tool`; both in base, timestamps ascending, at least partly free of contact.
[[nodiscard]] Segmentation segment_contacts(std::span<const double> t_force,
                                            std::span<const Eigen::Vector3d> force_base,
                                            std::span<const double> t_tool,
                                            std::span<const Eigen::Vector3d> p_base_tip,
                                            const SegmentationOptions& options = {});

}  // namespace pcavr
