// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kStiffness = 8e3;          // [N/m]
constexpr double kDamping = 20.0;           // [N s/m]
constexpr double kMass = 0.5;               // [kg] of the contact
constexpr double kFrequency = 10.0;         // [Hz] of the modulation
constexpr double kAmplitude = 0.001;        // [m]
constexpr double kBegin = 1.0, kEnd = 4.0;  // [s] of the modulation

struct Penetration {
  double x = 0.0, rate = 0.0, acceleration = 0.0;
};

/// Free until 0.5 s, 2 mm deep with a modulation from 1 s to 4 s, then free.
Penetration penetration_at(double t) {
  const auto ramp = [](double u) {  // from 0 to 1 within 0.3 s, twice differentiable
    const double s = std::clamp(u / 0.3, 0.0, 1.0);
    return Penetration{s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
                       30.0 * s * s * (1.0 - s) * (1.0 - s) / 0.3,
                       60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 0.09};
  };
  const Penetration in = ramp(t - 0.5), out = ramp(t - 4.3);
  constexpr double kWay = 0.007;
  Penetration p{-0.005 + kWay * (in.x - out.x), kWay * (in.rate - out.rate),
                kWay * (in.acceleration - out.acceleration)};
  const double w = 2.0 * std::numbers::pi * kFrequency;
  const Penetration on = ramp(t - kBegin), off = ramp(t - kEnd + 0.3);
  const double a = kAmplitude * (on.x - off.x), da = kAmplitude * (on.rate - off.rate);
  const double dda = kAmplitude * (on.acceleration - off.acceleration);
  p.x += a * std::sin(w * t);
  p.rate += da * std::sin(w * t) + a * w * std::cos(w * t);
  p.acceleration +=
      dda * std::sin(w * t) + 2.0 * da * w * std::cos(w * t) - a * w * w * std::sin(w * t);
  return p;
}

double force_at(double t) {
  const Penetration p = penetration_at(t);
  if (p.x <= 0.0) return 0.0;
  return std::max(0.0, kStiffness * p.x + kDamping * p.rate + kMass * p.acceleration);
}

/// A tip on the top of an immovable box, with the simulated sensors' noise.
TeleopInput mass_damper_spring_input(bool with_mass) {
  TeleopInput input;
  const Eigen::Vector3d half(0.1, 0.1, 0.05);
  TeleopObject object{
      "box", box_model("box", half), Pose::from_translation({0.6, 0.0, 0.05}), {}, {}};
  object.is_movable = false;
  object.parameters.contact_stiffness = ParameterValue{kStiffness};
  object.parameters.contact_damping = ParameterValue{kDamping};
  object.parameters.contact_exponent = ParameterValue{1.0};
  if (with_mass) object.parameters.contact_mass = ParameterValue{kMass};
  input.objects.push_back(std::move(object));
  input.tool_radius = 0.01;
  Random random(3);
  for (int i = 0; i < 2700; ++i) {
    const double t = 0.002 * i;
    input.t_tool.push_back(t);
    const double z = 0.11 - penetration_at(t).x + 5e-5 * random.normal();
    input.p_base_tip.emplace_back(0.6 + 5e-5 * random.normal(), 5e-5 * random.normal(), z);
    input.t_force.push_back(t + 0.001);
    input.force_base.emplace_back(0.2 * random.normal(), 0.2 * random.normal(),
                                  -force_at(t + 0.001) + 0.26 * random.normal());
  }
  return input;
}

/// Complex amplitude of a series at the modulation's frequency.
std::complex<double> amplitude(const std::vector<double>& t, const std::vector<double>& values) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    sum += values[i] * std::polar(1.0, -2.0 * std::numbers::pi * kFrequency * t[i]);
  }
  return 2.0 * sum / static_cast<double>(t.size());
}

struct Errors {
  double amplitude = 0.0, mean = 0.0;  ///< relative
};

Errors rendered_errors(bool with_mass) {
  TeleopOptions options;
  options.with_corrections = false;
  options.identifies = false;
  const TeleopRun run = run_teleop(mass_damper_spring_input(with_mass), options).value();
  std::vector<double> t, rendered, truth;
  for (const ForceRow& row : run.forces) {
    if (row.t < kBegin + 0.5 || row.t >= kBegin + 2.5) continue;  // whole periods
    t.push_back(row.t);
    rendered.push_back(row.predicted);
    truth.push_back(force_at(row.t));
  }
  EXPECT_GT(t.size(), 900U);
  double mean = 0.0, true_mean = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) mean += rendered[i], true_mean += truth[i];
  const std::complex<double> wanted = amplitude(t, truth);
  return {std::abs(amplitude(t, rendered) - wanted) / std::abs(wanted), mean / true_mean - 1.0};
}

TEST(ContactMass, IsIdentifiedFromAModulatedPress) {
  const TeleopInput input = mass_damper_spring_input(true);
  std::vector<double> tool, force;
  for (std::size_t i = 0; i < input.t_force.size(); ++i) {
    const std::size_t next = std::min(i + 1, input.t_tool.size() - 1);
    tool.push_back(-0.5 * (input.p_base_tip[i].z() + input.p_base_tip[next].z()));
    force.push_back(-input.force_base[i].z());
  }
  const ForceMotion press{input.t_force, tool, force};
  const ContactIdentification found = identify_contact(std::span(&press, 1));
  EXPECT_EQ(found.chosen, ContactRegressor::mass_damper_spring);
  ASSERT_TRUE(found.best().mass.is_excited);
  EXPECT_NEAR(found.best().mass.value, kMass, 0.05);
}

TEST(ContactMass, IsRenderedWithin2PercentOfTheForceAt10Hertz) {
  const Errors with = rendered_errors(true);
  EXPECT_LT(with.amplitude, 0.02);
  EXPECT_LT(std::abs(with.mean), 0.02);
  // The force is a third too large without the mass: it decreases where the tip is deepest.
  EXPECT_GT(rendered_errors(false).amplitude, 0.2);
}

}  // namespace
}  // namespace pcavr
