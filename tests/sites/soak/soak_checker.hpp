// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/teleoperation/link/command_buffer.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"

namespace pcavr {

/// Checks what two sites do against what must hold under any fault. All times [s] are true time,
/// which neither site knows; what happened is reported in its order. Deterministic.
class SoakChecker {
 public:
  struct Options {
    CommandOptions commands;  ///< of the robot's site
    MotionLimits limits;
    double cycle = 0.001;          ///< [s] of the robot's site
    double max_network = 0.5;      ///< [s] longest time a message is under way without a fault
    double revocation = 0.5;       ///< [s] within which a revoked key ends a session
    double recovery = 8.0;         ///< [s] within which commands are executed, once messages arrive
    double correction_time = 3.0;  ///< [s] within which a correction is applied without a fault
  };
  explicit SoakChecker(const Options& options) : options_(options) {}

  // The operator's site.
  void on_commanded(double t, std::uint32_t session, const LinkCommand& command);
  void on_applied(double t, std::uint32_t session, const LinkCorrection& correction, bool is_valid);
  // The network: a message that the operator's site sent at `sent` reaches the robot's site.
  void on_delivered(double t, double sent);
  /// Messages of the robot's site are lost until then: a session can't begin.
  void on_no_answers(double until);
  // The robot's site.
  void on_session(double t, std::uint32_t session, const std::string& key);
  void on_executed(double t, std::uint32_t session, const std::string& key,
                   const LinkCommand& command);
  void on_composed(double t, std::uint32_t session, const LinkCorrection& correction);
  void on_setpoint(double t, const Eigen::Vector3d& p_base);
  /// The site measures the force [N] that the tool exerts.
  void on_force(double t, const Eigen::Vector3d& force_base);
  /// The robot's process did not run until `t`, or begins: what it did before does not count.
  void on_robot_start(double t);
  // Keys.
  void authorize(const std::string& key) {
    revoked_.erase(key);
    authorized_.insert(key);
  }
  void revoke(double t, const std::string& key) {
    authorized_.erase(key);
    revoked_[key] = t;
  }

  /// The faults have ended long ago: the sites must work again.
  void check_recovered(double t);

  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
  [[nodiscard]] std::uint64_t digest() const { return digest_; }  ///< of all that was reported
  [[nodiscard]] std::size_t executed() const { return executed_count_; }
  [[nodiscard]] std::size_t applied() const { return applied_count_; }
  [[nodiscard]] double max_age() const { return max_age_; }  ///< [s] of an executed command
  [[nodiscard]] double path() const { return path_; }        ///< [m] of the setpoint
  [[nodiscard]] std::size_t pressed() const {
    return pressed_count_;
  }  ///< times the force limit acted

 private:
  struct Sent {
    double t_sent = 0.0;
    Eigen::Vector3f p_base_tip;
  };
  struct Corrections {
    std::map<std::uint32_t, double> composed;                    ///< number: when
    std::map<std::uint32_t, std::vector<std::uint8_t>> waiting;  ///< composed, not applied
    std::uint32_t applied_in_order = 0;
    std::set<std::uint32_t> applied_later;  ///< beyond a gap
  };
  struct Setpoint {
    double t = 0.0;
    Eigen::Vector3d p_base;
  };

  void violate(double t, const std::string& what);
  void mix(std::uint64_t value);
  void mix(double value);
  void check_key(double t, const std::string& key, const char* what);
  void check_execution(double t);
  void check_motion(double t, const Eigen::Vector3d& p_base);
  void check_force(double t, const Eigen::Vector3d& motion_base);
  [[nodiscard]] double max_speed() const;
  void forget_sessions(std::uint32_t newest);

  Options options_;
  std::map<std::uint32_t, std::map<double, Sent>> sent_;  ///< by session and time of execution
  std::map<std::uint32_t, Corrections> corrections_;      ///< by session
  std::set<std::string> authorized_;
  std::map<std::string, double> revoked_;
  std::optional<std::uint32_t> session_;  ///< of the robot's site
  std::optional<double> newest_due_;      ///< of the session's executed commands
  double last_executed_ = -1e9;           ///< [s] with the clutch closed
  double last_command_ = -1e9;            ///< [s] any was executed
  double connected_since_ = -1e9;         ///< [s] messages pass both ways without longer gaps
  double newest_delivered_sent_ = -1e9;
  double last_fresh_delivery_ = -1e9;
  std::deque<Setpoint> setpoints_;  ///< of the last tenth of a second
  Eigen::Vector3d force_base_ = Eigen::Vector3d::Zero();
  std::optional<double> pressed_since_;  ///< [s] the force is above its limit
  Eigen::Vector3d pressed_force_base_ = Eigen::Vector3d::Zero();  ///< [N] then
  double pressed_on_ = 0.0;  ///< [m] along the force since the tool had time to stop
  std::size_t pressed_count_ = 0;
  std::size_t executed_count_ = 0;
  std::size_t applied_count_ = 0;
  double max_age_ = 0.0;
  double path_ = 0.0;
  std::uint64_t digest_ = 14695981039346656037ULL;
  std::vector<std::string> violations_;
};

}  // namespace pcavr
