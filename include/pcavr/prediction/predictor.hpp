// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"
#include "pcavr/prediction/predicted_world.hpp"

namespace pcavr {

struct PredictorOptions {
  double step = 0.001;    ///< [s] the operator's cycle; haptics wants 1 kHz
  double memory = 2.0;    ///< [s] how far back a correction may speak
  double blending = 0.1;  ///< [s] in which what is shown moves over to a corrected state
};

/// A word about the past: what was so at `t`. Only what is set is changed.
struct Correction {
  double t = 0.0;  ///< [s] of the predictor's clock, within its memory
  std::size_t body = 0;
  std::optional<Pose> T_base_object = {};
  /// [vx vy omega] with the pose; without, the predicted one is kept if it slides there.
  std::optional<Eigen::Vector3d> twist = {};
  std::optional<BodyPhysics> physics = {};  ///< from t on
};

/// A body as it is shown and felt: after blending.
struct ShownBody {
  Pose T_base_object;
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< of the tip on the body [N]
  MotionPhase phase = MotionPhase::free;
};

/// The predicted world with a memory of inputs and states: a correction is applied at the time it
/// speaks of, and the present predicted again from there [methods of time warp; Mitra & Niemeyer
/// 2008, model-mediated telemanipulation]. Deterministic. One thread at a time; step() and
/// correct() do not allocate.
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

  /// False where `t` lies before the memory or after now(): nothing is changed.
  bool correct(const Correction& correction) noexcept;

  [[nodiscard]] const PredictedWorld& world() const;
  /// As it is shown now.
  [[nodiscard]] ShownBody shown(std::size_t body) const;
  /// The state predicted for a time within the memory, as it was after the latest correction.
  [[nodiscard]] std::optional<BodyState> state_at(std::size_t body, double t) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
