// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/prediction/predictor.hpp"
#include "pcavr/teleop/run_teleop.hpp"

#include "teleop/message.hpp"

namespace pcavr {

/// What the operator's site sends along with a command: its prediction of one object for the
/// instant at which the command will be carried out, and the last correction that it has.
struct Prediction {
  PlanarPlace place;
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< of the tip on the object [N]
  Eigen::Vector3d felt_base = Eigen::Vector3d::Zero();   ///< the same after blending [N]
  MotionPhase phase = MotionPhase::free;
  std::uint8_t received = 0;  ///< sequence of the last correction received
};

/// The site at which the operator sees and feels the predicted world. Time is the robot's: the
/// operator at work at w predicts w + forward delay.
class OperatorSite {
 public:
  /// Fails where an object cannot be made a body.
  [[nodiscard]] static Expected<OperatorSite> create(const TeleopInput& input,
                                                     const std::vector<BodyPhysics>& physics,
                                                     double round_trip, double start,
                                                     const Eigen::Vector3d& p_base_tip);

  /// A message that will be there at `arrival` of the operator's wall clock [s]. In order.
  void expect(double arrival, std::vector<std::uint8_t> bytes);
  /// One cycle, with what has come by `wall` [s].
  void step(double wall, const Eigen::Vector3d& p_base_tip);

  [[nodiscard]] double now() const { return predictor_.now(); }
  [[nodiscard]] Prediction prediction(std::size_t object) const;
  [[nodiscard]] ShownBody shown(std::size_t object) const { return predictor_.shown(object); }
  [[nodiscard]] std::size_t late() const { return late_; }

 private:
  struct Known {
    CadModel model;
    Pose T_base_start;
    ObjectParameters parameters;
    std::uint8_t received = 0;
  };
  struct Arriving {
    double at = 0.0;
    std::vector<std::uint8_t> bytes;
  };
  OperatorSite(Predictor predictor, std::vector<Known> objects, double epoch)
      : predictor_(std::move(predictor)), objects_(std::move(objects)), epoch_(epoch) {}
  void apply(const CorrectionMessage& message);

  Predictor predictor_;
  std::vector<Known> objects_;
  double epoch_;
  std::deque<Arriving> arriving_;
  std::size_t late_ = 0;
};

}  // namespace pcavr
