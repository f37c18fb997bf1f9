// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges of all options of this module: src/physics/prediction/options.cpp.
struct PredictorOptions {
  PredictorOptions();
  double step;          ///< [s] the operator's cycle; haptics requires 1 kHz
  double history;       ///< [s] length of the history: the maximum age of a correction
  double blending;      ///< [s] time in which the displayed state converges to a corrected one
  int max_corrections;  ///< remembered; of more, the oldest are not re-applied
};
[[nodiscard]] OptionSection section_of(PredictorOptions& options);

/// A measurement of the past, valid at `t`. Only what is set is changed.
struct Correction {
  double t = 0.0;  ///< [s] of the predictor's clock, within its history
  std::size_t body = 0;
  std::optional<Pose> T_base_object = {};
  /// [vx vy omega] with the pose; if empty, the predicted one is kept where the body slides.
  std::optional<Eigen::Vector3d> twist = {};
  std::optional<BodyPhysics> physics = {};  ///< from t on
};

/// A body as it is displayed and rendered to the haptic device: after blending.
struct ShownBody {
  Pose T_base_object;
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< of the tip on the body [N]
  MotionPhase phase = MotionPhase::free;
};

/// The predicted world with a history of inputs and states: rollback and re-simulation. A
/// correction is applied at its own time, and the present is predicted again from there [time warp;
/// Mitra & Niemeyer 2008, model-mediated telemanipulation]. Deterministic. One thread at a time;
/// step() and correct() do not allocate.
class Predictor {
 public:
  /// `start` [s] is the clock before the first step, with the tip at `p_base_tip`.
  Predictor(PredictedWorld world, double start, const Eigen::Vector3d& p_base_tip,
            const PredictorOptions& options = {});
  Predictor(Predictor&&) noexcept;
  Predictor& operator=(Predictor&&) noexcept;
  ~Predictor();

  /// One cycle: the tip's centre goes to `p_base_tip` until now() + options.step.
  void step(const Eigen::Vector3d& p_base_tip) noexcept;
  [[nodiscard]] double now() const;

  /// False where `t` lies before the history or after now(): nothing is changed.
  bool correct(const Correction& correction) noexcept;

  [[nodiscard]] const PredictedWorld& world() const;
  /// The body as it is displayed now.
  [[nodiscard]] ShownBody shown(std::size_t body) const;
  /// The state predicted for a time within the history, as it was after the latest correction.
  [[nodiscard]] std::optional<BodyState> state_at(std::size_t body, double t) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
