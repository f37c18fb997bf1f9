// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/contact_observer.hpp"
#include "pcavr/robots/robot_identification/exciting_motion.hpp"
#include "pcavr/robots/robot_identification/friction_intervals.hpp"
#include "pcavr/robots/robot_identification/friction_trial.hpp"
#include "pcavr/robots/robot_identification/joint_coupling.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/payload.hpp"
#include "pcavr/robots/robot_identification/replay_motion.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"
#include "pcavr/robots/robot_identification/sample_clock.hpp"

namespace pcavr {

struct RobotIdentificationOptions {
  JointSignalOptions signals;
  RobotFitOptions fit;
  ContactObserverOptions contact;
  FrictionTrialOptions trial;
  FrictionIntervalOptions intervals;
  ExcitingMotionOptions plan;
  PayloadOptions payload;
  bool is_trial_wanted = false;  ///< paper A's trial, to compare with
  /// [N m/A] by joint of the log's columns, for currents; empty where the log has torques.
  std::vector<double> gains = {};
};

/// Factor from a drive's current to its joint's torque.
struct JointGain {
  std::string joint;
  double gain = 0.0;  ///< [N m/A]
  double std = 0.0;   ///< [N m/A]
};

struct RobotIdentification {
  RobotModel model;  ///< with the log's joints alone
  /// As fitted: in the chain's order, torques from currents and without those of couplings,
  /// unwrapped.
  JointLog log;
  SampleClock clock;
  JointSignals signals;
  /// The fit of all rows; its errors and fitted torque are those of the fit of the first part
  /// alone, as are contacts, intervals, trial and replay.
  RobotFit fit;
  /// Transmissions that two joints share: their torques are part of the fitted torque, and taken
  /// from the recorded ones before contacts, trial, replay and load are looked at.
  std::vector<JointCoupling> couplings = {};
  /// Contacts in the held-out rows, with thresholds from the fitted ones; empty where the bodies
  /// aren't possible.
  std::optional<ObservedContacts> contacts = {};
  std::vector<JointGain> gains = {};           ///< where they were identified
  std::optional<Payload> payload = {};         ///< by add_payload
  std::vector<JointIntervals> intervals = {};  ///< friction by joint and position
  std::optional<FrictionTrial> trial = {};     ///< where it is wanted
  double fit_time = 0.0, trial_time = 0.0;     ///< [s] computing time
  MotionReplay replay;  ///< of the first held-out rows; empty where the bodies aren't possible
  std::vector<std::string> notes;
  std::vector<Error> warnings = {};  ///< faults of the log that were removed
  std::vector<std::pair<std::string, std::string>> configuration;  ///< changed options
};

/// `joints.csv` of a recording, or a file of its format.
[[nodiscard]] Expected<JointLog> read_joint_log(const std::filesystem::path& file_or_folder,
                                                bool skip_bad);

/// A log, and the file that names it in errors.
struct NamedLog {
  const JointLog& log;
  const std::string& file;
};

/// The gains of the drives by two logs of currents, of which one has a load of known mass [kg], in
/// the order of the logs' columns. Fails where a log has torques or faults in its rows, where their
/// columns differ, or where a gain is not determined.
[[nodiscard]] Expected<std::vector<JointGain>> find_drive_gains(
    const NamedLog& unloaded, const NamedLog& loaded, const RobotModel& model, double load_mass,
    const RobotIdentificationOptions& options);

/// Checks the log, fits the robot and replays the held-out motion. Fails where the log shows a
/// fault that must not be fitted; `file` names it in errors. Deterministic.
[[nodiscard]] Expected<RobotIdentification> identify_robot(
    JointLog log, const RobotModel& model, const RobotIdentificationOptions& options,
    const std::string& file);

/// Identifies what the arm carries in another log, which `file` names in errors; `found` is that of
/// the unloaded arm. Fails where the log has faults in its rows, or other joints.
[[nodiscard]] Expected<void> add_payload(JointLog loaded, const RobotIdentificationOptions& options,
                                         const std::string& file, const RobotModel& model,
                                         RobotIdentification& found);

/// report.html (write_report_page) and report.json (flat, SI) into a folder that exists.
[[nodiscard]] Expected<void> write_robot_report(const RobotIdentification& found,
                                                const std::string& log, const std::string& robot,
                                                const std::filesystem::path& folder);

}  // namespace pcavr
