// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/parameter_history.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

constexpr double kMinRelativeStep = 1e-3;  // that is a row

struct NamedField {
  const char* name;
  std::optional<ParameterValue> ObjectParameters::*field;
};
/// Names as in parameter files.
constexpr NamedField kHistoryFields[] = {
    {"contact.stiffness", &ObjectParameters::contact_stiffness},
    {"contact.damping", &ObjectParameters::contact_damping},
    {"contact.exponent", &ObjectParameters::contact_exponent},
    {"mass", &ObjectParameters::mass},
    {"limiting_static_friction", &ObjectParameters::limiting_static_friction},
    {"sliding_friction_coefficient", &ObjectParameters::sliding_friction_coefficient},
    {"viscous_friction", &ObjectParameters::viscous_friction},
};

bool has_changed(const std::optional<ParameterValue>& now,
                 const std::optional<ParameterValue>& before) {
  if (now.has_value() != before.has_value()) return true;
  return now && std::abs(now->value - before->value) > kMinRelativeStep * std::abs(before->value);
}

}  // namespace

ParameterHistory::ParameterHistory(std::vector<ObjectParameters> initial) {
  for (ObjectParameters& parameters : initial) {
    objects_.push_back({.running = parameters, .transmitted = std::move(parameters)});
  }
}

void ParameterHistory::send(double arrival, std::size_t object,
                            const ObjectParameters& parameters) {
  if (!is_empty(parameters)) objects_[object].in_flight.push_back({arrival, parameters});
}

std::vector<ParameterRow> ParameterHistory::advance(double t, std::size_t object,
                                                    const ObjectParameters& running) {
  Object& state = objects_[object];
  ObjectParameters transmitted = state.transmitted;
  while (!state.in_flight.empty() && state.in_flight.front().t <= t) {
    overwrite(transmitted, state.in_flight.front().parameters);
    state.in_flight.pop_front();
  }
  std::vector<ParameterRow> rows;
  for (const NamedField& named : kHistoryFields) {
    const auto& ran = running.*named.field;
    const auto& sent = transmitted.*named.field;
    if (state.is_written && !has_changed(ran, state.running.*named.field) &&
        !has_changed(sent, state.transmitted.*named.field)) {
      continue;
    }
    state.running.*named.field = ran;
    state.transmitted.*named.field = sent;
    if (ran && sent) rows.push_back({t, object, named.name, ran->value, sent->value});
  }
  // The state also has what is not listed, and changes too small for a row.
  state.transmitted = std::move(transmitted);
  state.is_written = true;
  return rows;
}

}  // namespace pcavr
