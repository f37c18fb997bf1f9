// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/parameter_trial.hpp"

#include <algorithm>

#include "teleop/correction_trial.hpp"

namespace pcavr {
namespace {

// Parameters are sent unless the prediction of a contact grows worse by this factor: its error has
// other causes too.
constexpr double kMaxErrorRatio = 1.5;
constexpr std::size_t kMaxKnown = 12;  // three contacts with the newest few parameters

/// Both are of one body: its limit surface keeps its shape.
bool are_same(const BodyPhysics& a, const BodyPhysics& b) {
  return a.friction.mass == b.friction.mass &&
         a.friction.limiting_force == b.friction.limiting_force &&
         a.friction.limiting_force_std == b.friction.limiting_force_std &&
         a.friction.coulomb_force == b.friction.coulomb_force &&
         a.friction.viscous == b.friction.viscous && a.contact.stiffness == b.contact.stiffness &&
         a.contact.damping == b.contact.damping && a.contact.exponent == b.contact.exponent &&
         a.contact_mass == b.contact_mass && a.surface_offset == b.surface_offset &&
         a.tool_friction == b.tool_friction && a.friction_radius == b.friction_radius;
}

}  // namespace

std::optional<double> KnownContactErrors::find(const RecordedContact& contact,
                                               const BodyPhysics& physics) const {
  const auto found = std::ranges::find_if(known_, [&](const Known& known) {
    return known.begin == contact.begin && known.end == contact.end &&
           are_same(known.physics, physics);
  });
  return found != known_.end() ? std::optional(found->error) : std::nullopt;
}

void KnownContactErrors::add(const ContactRun& run, double error) {
  if (known_.size() == kMaxKnown) known_.pop_front();
  known_.push_back({run.contact->begin, run.contact->end, run.physics, error});
}

std::optional<double> ParameterTrial::error_with(const BodyPhysics& physics, CorrectionTrial& trial,
                                                 KnownContactErrors& known, std::size_t& steps) {
  const Contact& contact = contacts_[next_];
  if (!run_) {
    if (const auto error = known.find(*contact.recorded, physics)) return error;
    run_ = ContactRun{.contact = contact.recorded, .physics = physics};
  }
  if (!trial.advance(*run_, steps)) return std::nullopt;
  const double error = trial.error_of(*run_);
  known.add(*run_, error);
  run_.reset();
  return error;
}

void ParameterTrial::advance(CorrectionTrial& trial, KnownContactErrors& known,
                             std::size_t& steps) {
  if (verdict_ != Verdict::undecided) return;
  for (; next_ < contacts_.size(); ++next_) {
    const Contact& contact = contacts_[next_];
    if (!before_) before_ = error_with(contact.before, trial, known, steps);
    if (!before_) return;
    const std::optional<double> after = error_with(contact.after, trial, known, steps);
    if (!after) return;
    if (*after > std::max(1.0, kMaxErrorRatio * *before_)) {
      verdict_ = Verdict::worse;
      return;
    }
    before_.reset();
  }
  verdict_ = Verdict::good;
}

}  // namespace pcavr
