// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/prediction/predictor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pcavr/core/check.hpp"

#include "prediction/correction_log.hpp"
#include "prediction/fading_offset.hpp"
#include "prediction/upright_body.hpp"

namespace pcavr {
namespace {

/// The place and the force that are shown, as six numbers: x, y, yaw, force.
Vector6d shown_of(const BodyState& state) {
  Vector6d shown;
  shown << state.planar.position, state.planar.yaw, state.tool_force_base;
  return shown;
}

/// Its rate. A force's is not told by the state: what is felt may turn sharply, but does not jump.
Vector6d rate_of(const BodyState& state) {
  Vector6d rate = Vector6d::Zero();
  rate.head<3>() = state.planar.twist;
  return rate;
}

}  // namespace

struct Predictor::Content {
  PredictedWorld world;
  double start;
  PredictorOptions options;
  std::int64_t steps = 0;  ///< done since the start
  // Rings by step: the tip and the states after it.
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<std::vector<BodyState>> states;
  detail::CorrectionLog log;
  std::vector<detail::FadingOffset> offsets;  ///< by body
  std::vector<BodyState> scratch;

  Content(PredictedWorld the_world, double the_start, const Eigen::Vector3d& tip,
          const PredictorOptions& the_options)
      : world(std::move(the_world)),
        start(the_start),
        options(the_options),
        p_base_tip(static_cast<std::size_t>(std::ceil(options.memory / options.step)) + 1, tip),
        states(p_base_tip.size(), world.state()),
        log(world),
        offsets(world.size()),
        scratch(world.state()) {}

  [[nodiscard]] std::size_t place_of(std::int64_t step) const {
    return static_cast<std::size_t>(step) % states.size();
  }
  [[nodiscard]] double time_of(std::int64_t step) const {
    return start + static_cast<double>(step) * options.step;
  }
  [[nodiscard]] std::int64_t oldest() const {
    return std::max<std::int64_t>(0, steps - static_cast<std::int64_t>(states.size()) + 1);
  }
  /// The step next to `t`; nothing outside the memory.
  [[nodiscard]] std::optional<std::int64_t> step_at(double t) const {
    const double step = std::round((t - start) / options.step);
    if (!(step >= static_cast<double>(oldest()) && step <= static_cast<double>(steps))) return {};
    return static_cast<std::int64_t>(step);
  }
  void keep(std::int64_t step) {
    std::copy(world.state().begin(), world.state().end(), states[place_of(step)].begin());
  }
  [[nodiscard]] Vector6d shown(std::size_t body) const {
    return shown_of(world.state()[body]) + offsets[body].value_at(time_of(steps));
  }
  [[nodiscard]] Vector6d shown_rate(std::size_t body) const {
    return rate_of(world.state()[body]) + offsets[body].rate_at(time_of(steps));
  }
  void predict_again_from(std::int64_t step) {
    for (std::int64_t i = step + 1; i <= steps; ++i) {
      world.step(p_base_tip[place_of(i - 1)], p_base_tip[place_of(i)], options.step);
      log.apply(i, world, scratch);
      keep(i);
    }
  }
  /// Remembers what is shown as an offset to the present state, and subtracts it after a change.
  template <typename Change>
  void change_unseen(const Change& change) {
    const double now = time_of(steps);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      offsets[i].begin(now, options.blending, shown(i), shown_rate(i));
    }
    change();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      offsets[i].begin(now, options.blending, offsets[i].value_at(now) - shown_of(world.state()[i]),
                       offsets[i].rate_at(now) - rate_of(world.state()[i]));
    }
  }
};

Predictor::Predictor(PredictedWorld world, double start, const Eigen::Vector3d& p_base_tip,
                     const PredictorOptions& options) {
  PCAVR_REQUIRE(std::isfinite(start), start);
  PCAVR_REQUIRE(p_base_tip.allFinite());
  PCAVR_REQUIRE(options.step > 0.0 && std::isfinite(options.step), options.step);
  PCAVR_REQUIRE(options.memory >= 0.0 && options.memory / options.step < 1e7, options.memory);
  PCAVR_REQUIRE(options.blending >= 0.0 && std::isfinite(options.blending), options.blending);
  content_ = std::make_unique<Content>(std::move(world), start, p_base_tip, options);
}
Predictor::Predictor(Predictor&&) noexcept = default;
Predictor& Predictor::operator=(Predictor&&) noexcept = default;
Predictor::~Predictor() = default;

void Predictor::step(const Eigen::Vector3d& p_base_tip) noexcept {
  Content& c = *content_;
  const Eigen::Vector3d before = c.p_base_tip[c.place_of(c.steps)];
  // A tip that nobody can place stays where it was.
  const Eigen::Vector3d after = p_base_tip.allFinite() ? p_base_tip : before;
  ++c.steps;
  c.p_base_tip[c.place_of(c.steps)] = after;
  c.world.step(before, after, c.options.step);
  c.keep(c.steps);
  c.log.forget_before(c.oldest());
}

double Predictor::now() const { return content_->time_of(content_->steps); }

bool Predictor::correct(const Correction& correction) noexcept {
  Content& c = *content_;
  const auto step = c.step_at(correction.t);
  if (!step || correction.body >= c.world.size()) return false;
  if (correction.twist && !correction.twist->allFinite()) return false;
  if (correction.physics && !detail::is_physical(*correction.physics)) return false;
  c.change_unseen([&] {
    c.log.add(*step, correction);
    c.log.restore_physics(*step, c.world);
    c.world.set_state(c.states[c.place_of(*step)]);
    detail::apply_pose(correction, c.world, c.scratch);
    c.keep(*step);
    c.predict_again_from(*step);
  });
  return true;
}

const PredictedWorld& Predictor::world() const { return content_->world; }

ShownBody Predictor::shown(std::size_t body) const {
  PCAVR_REQUIRE(body < content_->world.size(), body);
  const Vector6d shown = content_->shown(body);
  BodyState state = content_->world.state()[body];
  state.planar.position = shown.head<2>();
  state.planar.yaw = shown[2];
  return {content_->world.pose_of(body, state), shown.tail<3>(), state.phase};
}

std::optional<BodyState> Predictor::state_at(std::size_t body, double t) const {
  PCAVR_REQUIRE(body < content_->world.size(), body);
  const auto step = content_->step_at(t);
  if (!step) return std::nullopt;
  return content_->states[content_->place_of(*step)][body];
}

}  // namespace pcavr
