// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// Std of one parameter, now and expected after the planned motion.
struct PlannedStd {
  std::string name;  ///< as in the parameter file
  std::string unit;
  std::optional<double> now = {};       ///< std; empty: not identified
  std::optional<double> expected = {};  ///< empty: nothing is known yet to predict it from
  std::optional<double> wished = {};    ///< empty: the value is not known, of which it is a share
};

/// The contacts of a next recording with one object.
struct ObjectPlan {
  std::string name;
  int press_series = 0;        ///< each with one press at each of kPressSpeeds
  double press_depth = 0.0;    ///< [m] of the command below the surface
  int breakaways = 0;          ///< slow pushes until the object slides
  double loading_speed = 0.0;  ///< [m/s] of these, and of each slide's begin
  int slides = 0;
  SlideMotion slide;
  bool is_enough = true;  ///< the wished stds are expected
  std::vector<PlannedStd> stds = {};
  std::vector<std::string> notes = {};  ///< what the planned motion does not do, and why

  [[nodiscard]] bool is_empty() const { return press_series + breakaways + slides == 0; }
};

/// A command of the tip's centre.
struct PlannedPoint {
  double t = 0.0;          ///< [s]
  Eigen::Vector3d p_base;  ///< [m]
};

struct MotionPlan {
  std::vector<ObjectPlan> objects;  ///< as in the identification
  std::vector<PlannedPoint> path;   ///< empty where no contact is needed; 100 Hz, begins above
};

/// The motion of a next recording by which the parameters of `found` get the wished stds
/// (`options.plan`), and the stds to be expected: computed, not taken from a table
/// (motion_plan.hpp). The objects stand where `input` saw them last. Deterministic.
[[nodiscard]] MotionPlan plan_motion(const IdentificationInput& input, const Identification& found,
                                     const IdentificationOptions& options);

/// "t,x,y,z" and a row for each point: the trace of operator-site and of replayed devices.
[[nodiscard]] std::string format_path(const MotionPlan& plan);

/// The plan in words, a line each: contacts, then stds.
[[nodiscard]] std::vector<std::string> describe_plan(const MotionPlan& plan);

}  // namespace pcavr
