// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/input_monitor.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "inputs/simulated_series.hpp"
#include "pipeline/input_faults.hpp"

namespace pcavr {
namespace {

/// `times` copies of a recording with a second between them.
IdentificationInput repeated(const IdentificationInput& once, int times) {
  IdentificationInput input = once;
  const double period = once.t_tool.back() - once.t_tool.front() + 1.0;
  for (int i = 1; i < times; ++i) {
    for (std::size_t k = 0; k < once.t_tool.size(); ++k) {
      input.t_tool.push_back(once.t_tool[k] + period * i);
      input.p_base_tip.push_back(once.p_base_tip[k]);
      input.q_base_tool.push_back(once.q_base_tool[k]);
    }
    for (std::size_t k = 0; k < once.t_force.size(); ++k) {
      input.t_force.push_back(once.t_force[k] + period * i);
      input.force_base.push_back(once.force_base[k]);
    }
    for (std::size_t object = 0; object < once.objects.size(); ++object) {
      for (TrackedPose pose : once.objects[object].tracked) {
        pose.t += period * i;
        input.objects[object].tracked.push_back(pose);
      }
    }
  }
  return input;
}

struct Result {
  InputFindings findings;
  std::vector<Contact> contacts;
  std::size_t early_contacts = 0;  ///< before the end of the stream
};

Result whole(const IdentificationInput& input, const InputOptions& options) {
  Result result;
  result.findings = examine_inputs(series_view(input), options, [&](Contact&& contact) {
    result.contacts.push_back(std::move(contact));
  });
  return result;
}

/// Feeds the samples in order of time, each stream delayed by up to `latency` [s] in blocks of
/// random length, and asks in between.
Result streamed(const IdentificationInput& input, const InputOptions& options, double latency,
                std::uint64_t seed) {
  Result result;
  InputMonitor monitor(series_view(input).bodies, input.tool_radius, options,
                       [&](Contact&& contact) { result.contacts.push_back(std::move(contact)); });
  Random random(seed);
  std::size_t tool = 0, force = 0;
  std::vector<std::size_t> tracked(input.objects.size(), 0);
  const double end = std::max(input.t_tool.back(), input.t_force.back()) + latency;
  for (double now = input.t_tool.front(); now <= end + 0.1; now += 0.05 + 0.1 * random.uniform()) {
    const auto until = [&] { return now > end ? 1e300 : now - latency * random.uniform(); };
    for (const double t = until(); tool < input.t_tool.size() && input.t_tool[tool] <= t; ++tool) {
      monitor.add_tool(input.t_tool[tool], input.p_base_tip[tool], input.q_base_tool[tool]);
    }
    for (const double t = until(); force < input.t_force.size() && input.t_force[force] <= t;
         ++force) {
      monitor.add_force(input.t_force[force], input.force_base[force]);
    }
    for (std::size_t i = 0; i < tracked.size(); ++i) {
      const std::vector<TrackedPose>& poses = input.objects[i].tracked;
      for (const double t = until(); tracked[i] < poses.size() && poses[tracked[i]].t <= t;
           ++tracked[i]) {
        monitor.add_tracked(i, poses[tracked[i]]);
      }
    }
    if (random.uniform() < 0.01) (void)monitor.findings();
  }
  result.early_contacts = result.contacts.size();
  result.findings = monitor.finish();
  return result;
}

std::string fault_of(const InputFindings& findings) {
  return findings.fault ? findings.fault->error.message : std::string();
}

void expect_same(const Result& a, const Result& b) {
  EXPECT_EQ(fault_of(a.findings), fault_of(b.findings));
  EXPECT_EQ(a.findings.notes, b.findings.notes);
  EXPECT_EQ(a.findings.contacts, b.findings.contacts);
  EXPECT_EQ(a.findings.tool_to_force.offset, b.findings.tool_to_force.offset);
  EXPECT_EQ(a.findings.tool_to_camera.offset, b.findings.tool_to_camera.offset);
  EXPECT_EQ(a.findings.force_ceiling, b.findings.force_ceiling);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    EXPECT_EQ(a.contacts[i].begin, b.contacts[i].begin);
    EXPECT_EQ(a.contacts[i].object, b.contacts[i].object);
    EXPECT_EQ(a.contacts[i].left_out, b.contacts[i].left_out);
  }
}

class StreamedInput : public testing::Test {
 protected:
  static const IdentificationInput& sound() {
    static const IdentificationInput input = simulated_input(12.0);
    return input;
  }
};

TEST_F(StreamedInput, GivesWhatTheWholeRecordingGives) {
  const IdentificationInput input = repeated(sound(), 4);
  InputOptions options;
  options.window = 15.0;  // a recording has several
  const Result at_once = whole(input, options);
  EXPECT_GT(at_once.findings.contacts, 8U);
  for (const std::uint64_t seed : {1U, 2U}) {
    const Result fed = streamed(input, options, 2.0, seed);
    expect_same(fed, at_once);
    EXPECT_GT(fed.early_contacts, 0U);
  }
}

TEST_F(StreamedInput, FindsFaultsAndOffsetsAsTheWholeRecordingDoes) {
  InputOptions options;
  options.window = 15.0;
  for (const Change& change : {Change(flip_sign), delay_force(0.05), scale_force(1e3)}) {
    IdentificationInput input = repeated(sound(), 3);
    change(input);
    expect_same(streamed(input, options, 1.0, 3), whole(input, options));
  }
}

TEST_F(StreamedInput, FindsTheSameInSmallWindowsAsInOne) {
  const IdentificationInput input = repeated(sound(), 4);
  InputOptions small;
  small.window = 15.0;
  const Result one = whole(input, InputOptions{});
  const Result many = whole(input, small);
  EXPECT_EQ(fault_of(many.findings), "");
  EXPECT_EQ(many.findings.contacts, one.findings.contacts);
  EXPECT_EQ(many.findings.notes, one.findings.notes);
  ASSERT_EQ(many.contacts.size(), one.contacts.size());
  for (std::size_t i = 0; i < one.contacts.size(); ++i) {
    EXPECT_EQ(many.contacts[i].object, one.contacts[i].object) << i;
    EXPECT_NEAR(many.contacts[i].begin, one.contacts[i].begin, 0.01) << i;
  }
}

TEST_F(StreamedInput, RefinesWhatItFinds) {
  IdentificationInput input = sound();
  delay_force(0.05)(input);
  InputMonitor monitor(series_view(input).bodies, input.tool_radius, {});
  EXPECT_FALSE(monitor.findings().tool_to_force.is_known);
  double std = 1.0;
  std::size_t force = 0;
  for (std::size_t i = 0; i < input.t_tool.size(); ++i) {
    monitor.add_tool(input.t_tool[i], input.p_base_tip[i], input.q_base_tool[i]);
    for (; force < input.t_force.size() && input.t_force[force] <= input.t_tool[i]; ++force) {
      monitor.add_force(input.t_force[force], input.force_base[force]);
    }
    if (i % 2000 != 1999) continue;
    const TimeOffset offset = monitor.findings().tool_to_force;
    if (!offset.is_known) continue;
    EXPECT_LT(offset.std, 1.2 * std) << input.t_tool[i];
    std = offset.std;
  }
  EXPECT_TRUE(monitor.finish().is_force_offset_applied);
  EXPECT_NEAR(monitor.finish().tool_to_force.offset, 0.05, 0.002);
}

TEST_F(StreamedInput, IgnoresStampsThatDoNotAscend) {
  InputMonitor monitor(series_view(sound()).bodies, 0.01, {});
  monitor.add_tool(1.0, Eigen::Vector3d::Zero());
  monitor.add_tool(1.0, Eigen::Vector3d::Zero());
  monitor.add_tool(0.5, Eigen::Vector3d::Zero());
  monitor.add_force(1.0, Eigen::Vector3d::Zero());
  EXPECT_EQ(monitor.findings().contacts, 0U);
}

TEST_F(StreamedInput, OfNothingHasNoFault) {
  InputMonitor monitor({}, 0.01, {});
  EXPECT_FALSE(monitor.findings().fault.has_value());
  EXPECT_FALSE(monitor.finish().no_contact.has_value());
}

}  // namespace
}  // namespace pcavr
