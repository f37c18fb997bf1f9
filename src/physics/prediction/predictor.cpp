// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/predictor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"

#include "physics/prediction/correction_log.hpp"
#include "physics/prediction/fading_offset.hpp"
#include "physics/prediction/upright_body.hpp"

namespace pcavr {
namespace {

/// The displayed pose and force, as six numbers: x, y, yaw, force.
Vector6d shown_of(const BodyState& state) {
  Vector6d shown;
  shown << state.planar.position, state.planar.yaw, state.tool_force_base;
  return shown;
}

/// Its rate. The force's rate is not part of the state: the rendered force has no jump, but may
/// have a kink.
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
  // Ring buffers by step: the tip and the states after it.
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
        p_base_tip(static_cast<std::size_t>(std::ceil(options.history / options.step)) + 1, tip),
        states(p_base_tip.size(), world.state()),
        log(world, static_cast<std::size_t>(options.max_corrections)),
        offsets(world.size()),
        scratch(world.state()) {}

  [[nodiscard]] std::size_t index_of(std::int64_t step) const {
    return static_cast<std::size_t>(step) % states.size();
  }
  [[nodiscard]] double time_of(std::int64_t step) const {
    return start + static_cast<double>(step) * options.step;
  }
  [[nodiscard]] std::int64_t oldest() const {
    return std::max<std::int64_t>(0, steps - static_cast<std::int64_t>(states.size()) + 1);
  }
  /// The step nearest to `t`; empty outside the history.
  [[nodiscard]] std::optional<std::int64_t> step_at(double t) const {
    const double step = std::round((t - start) / options.step);
    if (!(step >= static_cast<double>(oldest()) && step <= static_cast<double>(steps))) return {};
    return static_cast<std::int64_t>(step);
  }
  void save_state(std::int64_t step) {
    std::copy(world.state().begin(), world.state().end(), states[index_of(step)].begin());
  }
  [[nodiscard]] Vector6d shown(std::size_t body) const {
    return shown_of(world.state()[body]) + offsets[body].value_at(time_of(steps));
  }
  [[nodiscard]] Vector6d shown_rate(std::size_t body) const {
    return rate_of(world.state()[body]) + offsets[body].rate_at(time_of(steps));
  }
  void resimulate_from(std::int64_t step) {
    for (std::int64_t i = step + 1; i <= steps; ++i) {
      world.step(p_base_tip[index_of(i - 1)], p_base_tip[index_of(i)], options.step);
      log.apply(i, world, scratch);
      save_state(i);
    }
  }
  /// Blends what is displayed over a change of the state: the offset that keeps it continuous
  /// fades.
  template <typename Change>
  void change_with_blending(const Change& change) {
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
  PCAVR_REQUIRE(options.history >= 0.0 && options.history / options.step < 1e7, options.history);
  PCAVR_REQUIRE(options.blending >= 0.0 && std::isfinite(options.blending), options.blending);
  PCAVR_REQUIRE(options.max_corrections >= 1, options.max_corrections);
  content_ = std::make_unique<Content>(std::move(world), start, p_base_tip, options);
}
Predictor::Predictor(Predictor&&) noexcept = default;
Predictor& Predictor::operator=(Predictor&&) noexcept = default;
Predictor::~Predictor() = default;

void Predictor::step(const Eigen::Vector3d& p_base_tip) noexcept {
  Content& c = *content_;
  const Eigen::Vector3d before = c.p_base_tip[c.index_of(c.steps)];
  // An invalid tip position is ignored: the tip stays where it was.
  const Eigen::Vector3d after = p_base_tip.allFinite() ? p_base_tip : before;
  ++c.steps;
  c.p_base_tip[c.index_of(c.steps)] = after;
  c.world.step(before, after, c.options.step);
  c.save_state(c.steps);
  c.log.discard_before(c.oldest());
}

double Predictor::now() const { return content_->time_of(content_->steps); }

bool Predictor::correct(const Correction& correction) noexcept {
  Content& c = *content_;
  const auto step = c.step_at(correction.t);
  if (!step || correction.body >= c.world.size()) return false;
  if (correction.twist && !correction.twist->allFinite()) return false;
  if (correction.physics && !detail::is_physical(*correction.physics)) return false;
  c.change_with_blending([&] {
    c.log.add(*step, correction);
    c.log.restore_physics(*step, c.world);
    c.world.set_state(c.states[c.index_of(*step)]);
    detail::apply_pose(correction, c.world, c.scratch);
    c.save_state(*step);
    c.resimulate_from(*step);
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
  return content_->states[content_->index_of(*step)][body];
}

}  // namespace pcavr
