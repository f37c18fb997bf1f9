// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/input_faults.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {
namespace {

constexpr double kHalfProbe = 16.0;  // [s] presses and slow pushes

std::string failure_of(const IdentificationInput& input) {
  const auto found = identify(input, IdentificationGoal::friction);
  return found ? std::string() : found.error().to_string();
}

/// The tool is tilted, so that its axes differ from base and object axes.
IdentificationInput tilted_probe(std::uint64_t seed, double duration) {
  IdentificationInput input = identified_case(ToolTask::probe, seed, duration).input;
  const Eigen::Quaterniond tilt(
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  for (Eigen::Quaterniond& q : input.q_base_tool) q = tilt * q;
  return input;
}

TEST(InputFaults, AreReported) {
  const IdentificationInput sound = tilted_probe(2, kHalfProbe);
  ASSERT_EQ(failure_of(sound), "");
  for (const Fault& fault : faults()) {
    IdentificationInput input = sound;
    fault.apply(input);
    EXPECT_NE(failure_of(input).find(fault.expected_text), std::string::npos)
        << fault.name << ": " << failure_of(input);
  }
}

/// The first press of `whole` with 0.3 s of free motion on either side, in `count` samples.
IdentificationInput one_press(const IdentificationInput& whole, std::size_t count) {
  // The press has many successive samples: single ones are spikes.
  const auto is_pressed = [](const Eigen::Vector3d& force, bool expected) {
    return (force.norm() > 3.0) == expected;
  };
  const auto at = [&](auto it) { return whole.t_force[it - whole.force_base.begin()]; };
  const auto last = whole.force_base.end();
  const auto begin = std::search_n(whole.force_base.begin(), last, 20, true, is_pressed);
  const auto end = std::search_n(begin, last, 20, false, is_pressed);
  const double from = at(begin) - 0.3, to = at(end) + 0.3;
  IdentificationInput press = whole;
  press.q_base_tool.clear();
  for (auto* const all : {&press.t_force, &press.t_tool}) all->clear();
  for (auto* const all : {&press.force_base, &press.p_base_tip}) all->clear();
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const double t = from + share * (to - from);
    const auto nearest = [t](const std::vector<double>& stamps) {
      return std::lower_bound(stamps.begin(), stamps.end(), t) - stamps.begin();
    };
    press.t_force.push_back(whole.t_force[nearest(whole.t_force)]);
    press.force_base.push_back(whole.force_base[nearest(whole.t_force)]);
    press.t_tool.push_back(whole.t_tool[nearest(whole.t_tool)]);
    press.p_base_tip.push_back(whole.p_base_tip[nearest(whole.t_tool)]);
  }
  return press;
}

TEST(InputFaults, ShortRecordsAreNotCalledEmpty) {
  const IdentificationInput whole = identified_case(ToolTask::probe, 2, kHalfProbe).input;
  EXPECT_EQ(
      failure_of(one_press(whole, 19)),
      "wrench.csv: identification needs the tool's force in 20 samples, but the recording has "
      "19; record for longer, with free motion before and after the contact");
  EXPECT_EQ(failure_of(one_press(whole, 20)), "");
}

/// `input` between two times, at `interval`.
IdentificationInput between(const IdentificationInput& whole, double from, double to,
                            double interval) {
  IdentificationInput part = whole;
  part.q_base_tool.clear();
  const auto take = [&](const auto& t, const auto& values, auto& part_t, auto& part_values) {
    part_t.clear();
    part_values.clear();
    for (double at = from; at < to; at += interval) {
      const auto i = std::lower_bound(t.begin(), t.end(), at) - t.begin();
      part_t.push_back(t[i]);
      part_values.push_back(values[i]);
    }
  };
  take(whole.t_force, whole.force_base, part.t_force, part.force_base);
  take(whole.t_tool, whole.p_base_tip, part.t_tool, part.p_base_tip);
  return part;
}

TEST(InputFaults, DoNotBlameTheForceOfARecordInsideAPress) {
  const IdentificationInput whole = identified_case(ToolTask::press, 2, 9.0).input;
  EXPECT_NE(failure_of(between(whole, 7.72, 7.98, 0.010))
                .find("the tip is at box_1 from the first sample to the last"),
            std::string::npos);
}

TEST(InputFaults, LeaveNoLawToPressesThatBeginBeforeTheRecord) {
  const IdentificationInput whole = identified_case(ToolTask::press, 2, 9.0).input;
  struct Window {
    double from, to, rate;
  };
  int withheld = 0;
  for (const auto& [from, to, rate] :
       {Window{2.12, 2.66, 37.0}, Window{2.15, 2.72, 37.0}, Window{6.86, 7.18, 75.0}}) {
    SCOPED_TRACE(from);
    const auto found = identify(between(whole, from, to, 1.0 / rate), IdentificationGoal::contact);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    const ContactFit& law = found->objects[0].presses.best();
    if (!law.is_valid) {
      ++withheld;
      EXPECT_FALSE(found->objects[0].parameters.contact_stiffness.has_value());
      ASSERT_FALSE(found->objects[0].notes.empty());
      EXPECT_NE(found->objects[0].notes[0].find("no stiffness"), std::string::npos);
      continue;
    }
    EXPECT_LT(law.penetration_std, 1.0);
    EXPECT_LE(law.exponent.std, ContactFitOptions().prior_exponent_std);
  }
  EXPECT_GE(withheld, 1);
}

/// An untracked object's pose is uncertain after its first push: fewer faults are found, none
/// wrong.
TEST(InputFaults, AreNotConfusedWithOthersWithoutTracking) {
  IdentificationInput sound = tilted_probe(3, kHalfProbe);
  for (IdentifiableObject& object : sound.objects) object.tracked.clear();
  ASSERT_EQ(failure_of(sound), "");
  for (const Fault& fault : faults()) {
    IdentificationInput input = sound;
    fault.apply(input);
    const std::string text = failure_of(input);
    EXPECT_TRUE(!reports_fault(text) || text.find(fault.expected_text) != std::string::npos)
        << fault.name << ": " << text;
  }
}

TEST(InputFaults, DoNotIncludeASaturatedSensor) {
  IdentificationInput input = tilted_probe(2, kHalfProbe);
  for (Eigen::Vector3d& force : input.force_base) force = force.cwiseMax(-6.0).cwiseMin(6.0);
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(std::any_of(found->notes.begin(), found->notes.end(), [](const std::string& note) {
    return note.find("saturated") != std::string::npos;
  }));
}

/// The first `duration` seconds of the input.
IdentificationInput cut(IdentificationInput input, double duration) {
  const auto keep = [duration](std::vector<double>& t) {
    t.erase(std::lower_bound(t.begin(), t.end(), duration), t.end());
    return t.size();
  };
  input.p_base_tip.resize(keep(input.t_tool));
  input.q_base_tool.resize(input.t_tool.size(), Eigen::Quaterniond::Identity());
  input.force_base.resize(keep(input.t_force));
  return input;
}

/// A sound but incomplete recording has no fault; identify_many_test.cpp uses more seeds.
TEST(InputFaults, AreNotReportedForSoundRecordings) {
  for (const ToolTask task : {ToolTask::push, ToolTask::probe, ToolTask::press, ToolTask::turn}) {
    const IdentificationInput whole = identified_case(task, 41, 9.0).input;
    for (const double duration : {2.5, 9.0}) {
      IdentificationInput input = cut(whole, duration);
      EXPECT_FALSE(reports_fault(failure_of(input))) << failure_of(input);
      for (IdentifiableObject& object : input.objects) object.tracked.clear();
      EXPECT_FALSE(reports_fault(failure_of(input))) << "untracked: " << failure_of(input);
    }
  }
}

/// The tip slides along the face that it pushes: its force is perpendicular to its motion.
TEST(InputFaults, AreNotReportedWhereTheTipSlidesAlongAFace) {
  IdentifiedCase made = identified_case(ToolTask::probe, 2, 0.1);
  IdentificationInput input = made.input;
  const IdentifiableObject& box = input.objects[0];
  input.t_tool.clear();
  input.p_base_tip.clear();
  input.q_base_tool.clear();
  input.t_force.clear();
  input.force_base.clear();
  // The tip moves along the +y edge of the face whose outward normal is -x, 50 mm at 10 mm/s, 0.1
  // mm deep.
  double face = 0.0;
  for (const Eigen::Vector3f& v : box.model.mesh_object.vertices) {
    face = std::min(face, static_cast<double>(v.x()));
  }
  Random random(7);
  for (int i = 0; i < 3500; ++i) {
    // The driver's stamps jitter by nearly an interval.
    const double t = 0.002 * i + 0.0009 * (2.0 * random.uniform() - 1.0);
    const double pressed = std::clamp((t - 1.0) / 0.2, 0.0, 1.0) - std::clamp(t - 5.8, 0.0, 1.0);
    const double along = 0.010 * std::clamp(t - 1.0, 0.0, 5.0) - 0.025;
    const Eigen::Vector3d p_object(
        face - input.tool_radius - 0.005 * (1.0 - pressed) + 1e-4 * pressed, along,
        box.model.centre_of_mass_object.z());
    const Eigen::Vector3d force_object(2.4 * pressed, 0.3 * pressed, 0.0);
    input.t_tool.push_back(t);
    input.p_base_tip.push_back(box.T_base_object * p_object +
                               2e-5 * Eigen::Vector3d(random.normal(), random.normal(), 0.0));
    input.t_force.push_back(t);
    input.force_base.push_back(
        box.T_base_object.rotation() * force_object +
        0.02 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
  }
  const TrackedPose rest{0.0, box.T_base_object, 2e-4, 1e-3};
  input.objects[0].tracked = {rest};
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  for (const std::string& note : found->notes) EXPECT_FALSE(reports_fault(note)) << note;
  ASSERT_FALSE(found->contacts.empty());
  EXPECT_EQ(found->contacts[0].left_out, "");
}

TEST(InputFaults, APushTooShortToSlideGivesNoLimit) {
  const IdentificationInput whole = identified_case(ToolTask::push, 5, 4.0).input;
  const auto found = identify(whole, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value());
  const Contact& push = found->contacts.front();
  ASSERT_TRUE(push.breakaway.is_found);
  const double end = push.begin + 0.7 * (push.breakaway.t - push.begin);
  const auto shortened = identify(cut(whole, end), IdentificationGoal::friction);
  ASSERT_TRUE(shortened.has_value()) << shortened.error().to_string();
  EXPECT_FALSE(shortened->objects[0].parameters.limiting_static_friction.has_value());
  EXPECT_EQ(shortened->objects[0].limit.missed, 1);
}

TEST(ContactExponent, IsGivenWithARealisticStdWithoutPresses) {
  for (std::uint64_t seed = 51; seed <= 53; ++seed) {
    const IdentifiedCase made = identified_case(ToolTask::push, seed, 4.0);
    const auto found = identify(made.input, IdentificationGoal::friction);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (std::size_t i = 0; i < found->objects.size(); ++i) {
      const ObjectIdentification& box = found->objects[i];
      const auto& exponent = box.parameters.contact_exponent;
      if (!exponent) continue;
      ASSERT_TRUE(exponent->std.has_value());
      const double truth = made.plant.bodies[i].parameters.contact_exponent;
      EXPECT_LT(std::abs(exponent->value - truth), 3.0 * *exponent->std) << seed;
      const auto row = std::find_if(
          box.findings.begin(), box.findings.end(),
          [](const ParameterFinding& finding) { return finding.name == "contact.exponent"; });
      EXPECT_FALSE(row->is_excited);
      EXPECT_TRUE(row->remark.starts_with("given: ")) << row->remark;
    }
  }
}

}  // namespace
}  // namespace pcavr
