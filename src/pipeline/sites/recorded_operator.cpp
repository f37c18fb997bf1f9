// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/teleoperation/sites/operator_interface.hpp"

namespace pcavr {
namespace {

constexpr double kApproachSpeed = 0.1;  // [m/s] mean: unhurried, far below a robot's limits
constexpr double kApproachRest = 0.3;   // [s] at its end: the robot has come to rest
constexpr double kMinApproach = 0.001;  // [m] a shorter one is left to the robot's limits

/// Motion from a tip at rest to the begin of the recorded motion, with a smooth start and end.
class Approach {
 public:
  Approach() = default;
  /// Begins at `cycle`, of `step` [s].
  Approach(const Eigen::Vector3d& p_base_from, const Eigen::Vector3d& p_base_to, std::size_t cycle,
           double step)
      : p_base_from_(p_base_from), p_base_way_(p_base_to - p_base_from), begin_(cycle) {
    const double distance = p_base_way_.norm();
    if (distance < kMinApproach) return;
    duration_ = distance / kApproachSpeed;
    step_ = step;
    end_ = cycle + static_cast<std::size_t>(std::ceil((duration_ + kApproachRest) / step));
  }

  /// Cycle 0 of the recorded motion; 0: there is no approach.
  [[nodiscard]] std::size_t end() const { return end_; }
  [[nodiscard]] Eigen::Vector3d p_base(std::size_t cycle) const {
    const double s = share(cycle);
    return p_base_from_ + s * s * s * (10.0 - s * (15.0 - 6.0 * s)) * p_base_way_;
  }
  [[nodiscard]] Eigen::Vector3d a_base(std::size_t cycle) const {
    const double s = share(cycle);
    return s * (60.0 - s * (180.0 - 120.0 * s)) / (duration_ * duration_) * p_base_way_;
  }

 private:
  [[nodiscard]] double share(std::size_t cycle) const {
    const double passed = step_ * static_cast<double>(cycle - std::min(cycle, begin_));
    return std::min(passed / duration_, 1.0);
  }

  Eigen::Vector3d p_base_from_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_base_way_ = Eigen::Vector3d::Zero();
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  double duration_ = 1.0;  ///< [s]
  double step_ = 0.0;      ///< [s]
};

class RecordedOperator final : public OperatorInterface {
 public:
  RecordedOperator(RecordedCommand command, double step)
      : command_(std::move(command)), step_(step) {}

  [[nodiscard]] double start() const override { return command_.start(); }
  [[nodiscard]] std::optional<std::size_t> cycles() const override {
    return approach_.end() + command_.cycles();
  }
  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t next, const LinkState* robot) override {
    if (!has_begun_ && robot != nullptr) {
      approach_ =
          Approach(robot->p_base_tip.cast<double>(), command_.p_base_tip(0), next - 1, step_);
    }
    has_begun_ = true;
    return p_base_tip(next - 1);
  }
  [[nodiscard]] OperatorCommand step(std::size_t cycle, LiveOperatorSite& site,
                                     const OperatorLink&) override {
    const Eigen::Vector3d p_base = p_base_tip(cycle);
    const bool is_approach = cycle < approach_.end();
    site.step(p_base,
              is_approach ? approach_.a_base(cycle) : command_.a_base_tip(cycle - approach_.end()));
    return {p_base, Eigen::Quaterniond::Identity(), true, {}};
  }

 private:
  [[nodiscard]] Eigen::Vector3d p_base_tip(std::size_t cycle) {
    return cycle < approach_.end() ? approach_.p_base(cycle)
                                   : command_.p_base_tip(cycle - approach_.end());
  }

  RecordedCommand command_;
  double step_;  ///< [s]
  bool has_begun_ = false;
  Approach approach_;
};

}  // namespace

Expected<std::unique_ptr<OperatorInterface>> make_recorded_operator(const TeleopInput& world,
                                                                    const TeleopOptions& options) {
  Expected<RecordedCommand> command = RecordedCommand::create(world, options);
  if (!command) return command.error();
  return std::unique_ptr<OperatorInterface>(
      std::make_unique<RecordedOperator>(std::move(*command), options.predictor.step));
}

}  // namespace pcavr
