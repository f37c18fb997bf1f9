// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/sliding.hpp"
#include "pcavr/physics/inputs/input_options.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/physics/prediction/predictor.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

// Defaults, ranges, and what goes wrong at their ends: src/teleoperation/teleop/options.cpp.

/// Whether the tip touches an object, and the force sensor's bias ("teleop.touch").
struct TouchOptions {
  TouchOptions();
  double touch_clearance;  ///< [m] below: in contact
  double free_clearance;   ///< [m] above, of every object: the force is the sensor's bias
  double bias_time;        ///< [s] time constant of the bias
  double contact_stds;     ///< force at which a contact begins, over its std
  double force_drift;      ///< [N] minimum of that force
};

/// Prior knowledge of the robot site's sensors ("teleop.sensors"): from a calibration, or from an
/// earlier session. All of it is measured on the way, too.
struct SensorPriorOptions {
  SensorPriorOptions();
  double tip_noise;      ///< [m] std of one sample
  double force_noise;    ///< [N] std of one sample, each axis
  double force_offset;   ///< [s] by which the force's stamps are late
  double camera_offset;  ///< [s] by which those of the tracked poses are
};

/// Detection of free, static, critical and sliding at the robot's site ("teleop.phases").
struct PhaseMonitorOptions {
  PhaseMonitorOptions();
  double slide_speed;              ///< [m/s] minimum speed that is distinguished from rest
  double min_displacement;         ///< [m] minimum displacement of a slide
  int debounce_samples;            ///< consecutive samples that must agree
  double critical_share;           ///< of F_M: minimum width of the critical band below it
  double leave_ratio;              ///< of the contact force: a contact ends below
  double leave_time;               ///< [s] ... for this long
  double unloaded_time;            ///< [s] ... or this long, where the tip stays
  double retraction;               ///< [m] of the tip, at which a contact ends
  double line_guard;               ///< [s] newest samples that the contact line does not use
  double rate_window;              ///< [s] of the tip's speed, for damping
  double min_speed_window;         ///< [s] of the object's speed
  double max_speed_window;         ///< [s] of the object's speed
  double slow_slide_window;        ///< [s] shortest time in which tracking shows a slow slide
  double slow_slide_displacement;  ///< [m] minimum within that time
};

/// The robot site's pose estimate, from camera and contact ("teleop.pose").
struct PoseFusionOptions {
  PoseFusionOptions();
  double tracking_latency;         ///< [s]
  double initial_std;              ///< [m] of a pose that was never tracked
  double moved_stds;               ///< displacement between two frames, over its std: motion
  double min_displacement;         ///< [m] ... and at least this
  double min_speed;                ///< [m/s] ... and this
  double untracked_drift;          ///< growth of the std per displacement without tracking
  double contact_std;              ///< [m] of a touched surface's distance from the tip
  double default_penetration_std;  ///< relative, if the contact law states none
  double min_force;                ///< [N] below, contact gives no position
  double offset_gain;              ///< of the low-pass filter from camera to contact, per sample
  double clock_std;                ///< [s] of the frames' stamps on the tool's clock
  double max_surface_offset;       ///< [m] of the touched surface beyond the CAD body's; 0: none
};

/// Online identification at the robot's site ("teleop.learning"); the methods' own options are
/// nested, in their own sections.
struct LearningOptions {
  LearningOptions();
  double default_relative_std;  ///< of a parameter without a stated std
  double contradiction_stds;    ///< difference at which data contradict a parameter
  double model_error;           ///< relative difference that is never a contradiction
  double max_fit_error;         ///< of a contact law: relative force residual
  double max_penetration_std;   ///< of a contact law: relative
  double max_radius_std;        ///< of a friction radius: relative
  double min_peak_force;        ///< [N] of a contact that is used for the contact law
  double static_limit_ratio;    ///< static friction over F_M that contradicts it, ...
  double static_limit_time;     ///< [s] ... after this long
  double static_limit_factor;   ///< F_M until breakaway, over the largest static friction
  int max_fitted_contacts;      ///< newest ones, fitted together
  double max_contact_time;      ///< [s] of one contact that is used
  double delay_after_touch;     ///< [s] from a contact's begin to an identification of a first law
  double delay_after_onset;     ///< [s] from a slide's onset to its identification
  double sliding_interval;      ///< [s] between identifications during a slide
  double delay_after_stop;      ///< [s] from a slide's or contact's end to its identification
  SegmentationOptions segmentation;
  ContactFitOptions contact_fit;
  OnsetOptions onset;
  LimitingFrictionOptions limiting_friction;
  SlidingOptions sliding;  ///< its gravity is that of both sites
  FrictionPriors friction_priors;
  BreakawayPriors breakaway_priors;
  LimitSurfaceFitOptions limit_surface;
};

/// When a correction is sent [paper C] ("teleop.switch").
struct CorrectionSwitchOptions {
  CorrectionSwitchOptions();
  double force_tolerance;       ///< relative to the real force
  double position_tolerance;    ///< [m] maximum error without a correction
  double position_stds;         ///< position error over the estimate's std, ...
  double min_position_error;    ///< [m] ... at least this
  double phase_persistence;     ///< [s] after which a difference of the phases counts
  double force_persistence;     ///< [s] ... of the forces
  double position_persistence;  ///< [s] ... of the positions
  double max_lapse;             ///< [s] for which a difference may vanish meanwhile
  double round_trip_margin;     ///< [s] after a round trip until a case is sent again
  double growth_factor;         ///< of an error whose correction is in flight: sent again
  double max_threshold_factor;  ///< of the thresholds beyond the byte budget
  double byte_budget;           ///< of the corrections, relative to streaming
  double burst_bytes;           ///< [bytes] that may be sent beyond the budget
  bool keeps_off;               ///< case 2 keeps a live tool off until new parameters [paper C]
};

/// Content of a correction ("teleop.messages").
struct MessageOptions {
  MessageOptions();
  double min_pose_error;        ///< [m] from which on the pose is sent
  double rotation_radius;       ///< [m] at which a rotation counts as a displacement
  double min_parameter_change;  ///< relative, from which on parameters are sent
  double min_compared_force;    ///< [N] of contact laws
  double compared_rate;         ///< [m/s] of contact laws: rate of penetration
  bool parameters_by_force;     ///< case 1.3 sends one group of parameters [paper C]
};

/// Both sites and the link between them ("teleop").
struct TeleopOptions {
  TeleopOptions();
  double forward_delay;     ///< [s] operator to robot
  double backward_delay;    ///< [s] robot to operator
  double jitter;            ///< [s] std of either delay; messages keep their order
  double loss;              ///< packet loss of corrections, 0 to 1
  double burst;             ///< mean number of corrections lost in a row; below 1: independent
  double reorder;           ///< share of the corrections that are overtaken, 0 to 1
  double duplicate;         ///< share of the corrections that arrive twice, 0 to 1
  double rate_limit;        ///< [bytes/s] from robot to operator; 0: none
  std::uint64_t seed;       ///< of jitter and loss
  double retraction_speed;  ///< [m/s] of the tool out of what only the robot has touched
  bool with_corrections;    ///< false: predict only
  bool identifies;          ///< false: the parameters stay as given
  InputOptions inputs;      ///< how the inputs are examined on the way
  SensorPriorOptions sensors;
  TouchOptions touch;
  PhaseMonitorOptions phases;
  PoseFusionOptions pose;
  LearningOptions learning;
  CorrectionSwitchOptions correction_switch;
  MessageOptions messages;
  PredictorOptions predictor;       ///< its history is extended to a round trip
  WorldOptions world;               ///< of the prediction
  PhysicsDefaults unknown_objects;  ///< of the prediction

  [[nodiscard]] double round_trip() const { return forward_delay + backward_delay; }
  /// [m/s^2] of both sites.
  [[nodiscard]] double gravity() const { return learning.sliding.gravity; }
};

[[nodiscard]] OptionSection section_of(SensorPriorOptions& options);
[[nodiscard]] OptionSection section_of(TouchOptions& options);
[[nodiscard]] OptionSection section_of(PhaseMonitorOptions& options);
[[nodiscard]] OptionSection section_of(PoseFusionOptions& options);
[[nodiscard]] OptionSection section_of(LearningOptions& options);
[[nodiscard]] OptionSection section_of(CorrectionSwitchOptions& options);
[[nodiscard]] OptionSection section_of(MessageOptions& options);
/// The section without the nested options.
[[nodiscard]] OptionSection section_of(TeleopOptions& options);
/// "teleop" and its nested sections, and those of the methods that it uses.
[[nodiscard]] std::vector<OptionSection> sections_of(TeleopOptions& options);

}  // namespace pcavr
