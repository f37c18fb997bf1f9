// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/inputs/input_monitor.hpp"

#include "inputs/simulated_series.hpp"

namespace pcavr {
namespace {

struct Examined {
  InputFindings findings;
  std::vector<Contact> contacts;
};

Examined examined(const IdentificationInput& input) {
  Examined result;
  result.findings = examine_inputs(series_view(input), {}, [&](Contact&& contact) {
    result.contacts.push_back(std::move(contact));
  });
  return result;
}

/// Behind a low pass of first order [Hz].
IdentificationInput low_passed(IdentificationInput input, double cutoff) {
  const double interval = mean_interval(input.t_force);
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff * interval);
  Eigen::Vector3d state = input.force_base.front();
  for (Eigen::Vector3d& force : input.force_base) force = state += share * (force - state);
  return input;
}

IdentificationInput with_fast_force_clock(IdentificationInput input, double rate) {
  const double first = input.t_force.front();
  for (double& t : input.t_force) t = first + (t - first) * (1.0 + rate);
  return input;
}

bool has_line(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(
      lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

/// Mean difference of the forces of both at the tip's deepest quarter, over the peak.
void expect_same_presses(const Examined& found, const Examined& sound, double max_delay) {
  ASSERT_EQ(found.contacts.size(), sound.contacts.size());
  for (std::size_t i = 0; i < sound.contacts.size(); ++i) {
    const Contact& a = found.contacts[i];
    const Contact& b = sound.contacts[i];
    if (b.kind != ContactKind::press) continue;
    EXPECT_NEAR(a.peak_force, b.peak_force, 0.04 * b.peak_force);
    const auto half = [](const Contact& contact) {
      std::size_t k = 0;
      while (contact.force[k] < 0.5 * contact.peak_force) ++k;
      return contact.tool[k];
    };
    // At half the peak, approaching: the tip's place is wrong by its speed times the delay.
    const double speed =
        std::abs(a.tool[a.tool.size() / 2] - a.tool.front()) / (a.t[a.t.size() / 2] - a.t.front());
    EXPECT_NEAR(half(a), half(b), max_delay * speed + 1.5e-4);
  }
}

constexpr double kStreamsTime = 26.0;  // [s] presses and pushes

IdentificationInput presses() { return identified_case(ToolTask::press, 2, 12.0).input; }

TEST(ForceStreams, ALowPassIsUndoneAndNoted) {
  const IdentificationInput sound = simulated_input(kStreamsTime);
  const Examined expected = examined(sound);
  EXPECT_FALSE(has_line(expected.findings.notes, "low-pass"));
  for (const double cutoff : {8.0, 25.0}) {
    const Examined found = examined(low_passed(sound, cutoff));
    EXPECT_FALSE(found.findings.fault);
    EXPECT_TRUE(has_line(found.findings.notes, "low-pass"));
    const double share = std::exp(-2.0 * std::numbers::pi * cutoff * mean_interval(sound.t_force));
    const double delay = share / (1.0 - share) * mean_interval(sound.t_force);
    EXPECT_NEAR(found.findings.force_shift(), delay, 0.15 * delay + 0.0005);
    expect_same_presses(found, expected, 0.15 * delay);
  }
}

TEST(ForceStreams, ADriftingClockIsTakenOffAndWarnedOf) {
  const IdentificationInput sound = presses();
  const Examined expected = examined(sound);
  EXPECT_FALSE(has_line(expected.findings.warnings, "clock"));
  for (const double rate : {0.006, -0.006}) {
    const Examined found = examined(with_fast_force_clock(sound, rate));
    EXPECT_FALSE(found.findings.fault);
    EXPECT_TRUE(has_line(found.findings.warnings, "the force's clock is"));
    expect_same_presses(found, expected, 0.003);
  }
}

TEST(ForceStreams, AClockThatIsFarTooFastIsAFault) {
  const Examined found = examined(with_fast_force_clock(presses(), 0.02));
  ASSERT_TRUE(found.findings.fault);
  EXPECT_EQ(found.findings.fault->kind, InputFaultKind::clock);
}

}  // namespace
}  // namespace pcavr
