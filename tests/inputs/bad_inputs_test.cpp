// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/inputs/contact_clocks.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "inputs/simulated_series.hpp"
#include "pipeline/input_faults.hpp"

namespace pcavr {
namespace {

constexpr double kDuration = 16.0;  // [s] presses and slow pushes

/// One row: what is wrong with a recording, and what both commands must find.
struct BadInput {
  const char* name;
  Change apply;
  const char* fault = "";  ///< part of the message with which the force or the recording is refused
  const char* note = "";   ///< part of a note
  double force_late = 0.0;   ///< [s] the offset that is applied
  double camera_late = 0.0;  ///< [s]
  bool is_replayed = true;   ///< false: the tool's motion is unusable too
};

void saturate(IdentificationInput& input) {
  for (Eigen::Vector3d& force : input.force_base) force = force.cwiseMax(-6.0).cwiseMin(6.0);
}

void delay_tracking(IdentificationInput& input) {
  for (IdentifiableObject& object : input.objects) {
    for (TrackedPose& pose : object.tracked) pose.t += 0.1;
  }
}

void jump(IdentificationInput& input) {
  for (std::size_t i = input.p_base_tip.size() / 2; i < input.p_base_tip.size(); ++i) {
    input.p_base_tip[i].x() += 0.004;
  }
}

void add_spikes(IdentificationInput& input) {
  for (std::size_t i = 150; i < input.p_base_tip.size(); i += 700) input.p_base_tip[i].y() += 0.02;
}

void remove_contact(IdentificationInput& input) {
  for (std::size_t i = 0; i < input.force_base.size(); ++i) {
    // A periodic pattern as the sensor's noise.
    const double noise = 0.02 * (static_cast<double>(i % 5) - 2.0);
    input.force_base[i] = Eigen::Vector3d(noise, -noise, 0.5 * noise);
  }
  for (Eigen::Vector3d& p : input.p_base_tip) p.z() += 0.5;
  for (IdentifiableObject& object : input.objects) {
    for (TrackedPose& pose : object.tracked) pose.T_base_object = object.T_base_object;
  }
}

void write_tool_in_kilometres(IdentificationInput& input) {
  for (Eigen::Vector3d& p : input.p_base_tip) p *= 1e-3;
}

Change raise_tool(double height) {
  return [height](IdentificationInput& input) {
    for (Eigen::Vector3d& p : input.p_base_tip) p.z() += height;
  };
}

Change scale_meshes(float factor) {
  return [factor](IdentificationInput& input) {
    for (IdentifiableObject& object : input.objects) {
      for (Eigen::Vector3f& vertex : object.model.mesh_object.vertices) vertex *= factor;
    }
  };
}

void write_poses_in_millimetres(IdentificationInput& input) {
  for (IdentifiableObject& object : input.objects) {
    for (TrackedPose& pose : object.tracked) {
      pose.T_base_object =
          Pose(pose.T_base_object.rotation(), 1e3 * pose.T_base_object.translation());
    }
  }
}

void write_w_first(IdentificationInput& input) {
  for (IdentifiableObject& object : input.objects) {
    for (TrackedPose& pose : object.tracked) {
      const Eigen::Quaterniond q(pose.T_base_object.rotation());
      // Written w x y z, read as x y z w.
      const Eigen::Quaterniond read(q.z(), q.w(), q.x(), q.y());
      pose.T_base_object = Pose(read, pose.T_base_object.translation());
    }
  }
}

void leave_the_scene(IdentificationInput& input) {
  for (IdentifiableObject& object : input.objects) {
    object.T_base_object = Pose(object.T_base_object.rotation(),
                                object.T_base_object.translation() + Eigen::Vector3d(632.0, 0, 0));
  }
}

/// Turns the forces as a sensor that is mounted turned by `degrees` about an axis of the tool.
Change turn_sensor(const Eigen::Vector3d& axis_tool, double degrees) {
  return [=](IdentificationInput& input) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis_tool));
    std::size_t k = 0;
    for (std::size_t i = 0; i < input.force_base.size(); ++i) {
      while (k + 1 < input.t_tool.size() && input.t_tool[k] < input.t_force[i]) ++k;
      const Eigen::Quaterniond& q_base_tool = input.q_base_tool[k];
      input.force_base[i] = q_base_tool * turn * q_base_tool.conjugate() * input.force_base[i];
    }
  };
}

void forget_to_zero_the_sensor(IdentificationInput& input) {
  for (Eigen::Vector3d& force : input.force_base) force += Eigen::Vector3d(1.2, -3.4, 12.6);
}

const std::vector<BadInput>& bad_inputs() {
  static const std::vector<BadInput> all{
      {"sound", [](IdentificationInput&) {}},
      {"reversed force", flip_sign, "wrong sign"},
      {"force in other axes", swap_x_and_y, "other axes"},
      {"force in the tool's axes", write_in_tool_axes, "tool's axes"},
      {"sensor turned by 30 degrees", turn_sensor(Eigen::Vector3d::UnitZ(), 30.0), "turned by "},
      {"sensor tilted by 40 degrees", turn_sensor(Eigen::Vector3d::UnitX(), 40.0), "turned by "},
      {.name = "sensor not set to zero",
       .apply = forget_to_zero_the_sensor,
       .note = "N where the tip is far from every object"},
      {.name = "tool in millimetres",
       .apply = write_tool_in_millimetres,
       .fault = "in millimetres",
       .is_replayed = false},
      {.name = "mesh of twice its size",
       .apply = scale_meshes(2.0F),
       .fault = "0.5 times as large",
       .is_replayed = false},
      {.name = "mesh of half its size",
       .apply = scale_meshes(0.5F),
       .fault = "2 times as large",
       .is_replayed = false},
      {.name = "poses in millimetres",
       .apply = write_poses_in_millimetres,
       .fault = "are in millimetres",
       .is_replayed = false},
      {.name = "quaternions with w first",
       .apply = write_w_first,
       .fault = "begin with w",
       .is_replayed = false},
      {.name = "pose in the scene far off",
       .apply = leave_the_scene,
       .note = "632 m from its pose in the scene"},
      {.name = "tool in kilometres",
       .apply = write_tool_in_kilometres,
       .fault = "in kilometres",
       .is_replayed = false},
      {.name = "tool too high", .apply = raise_tool(0.19), .note = "at the closest 0.1"},
      {.name = "tool far too high",
       .apply = raise_tool(0.35),
       .note = "but farther than 0.2 m from each"},
      {"force in kilonewtons", scale_force(1e-3), "another unit"},
      {"force in grams-force", scale_force(1e3 / kStandardGravity), "another unit"},
      {.name = "force 3 s late",
       .apply = delay_force(3.0),
       .fault = "3.0 s later than the tool's motion",
       .is_replayed = false},
      {.name = "force 0.15 s late", .apply = delay_force(0.15), .force_late = 0.15},
      {.name = "tracking 0.1 s late", .apply = delay_tracking, .camera_late = 0.1},
      {.name = "saturated sensor", .apply = saturate, .note = "force sensor saturated"},
      {.name = "jump", .apply = jump, .note = "the tool's pose jumps 1 time"},
      {.name = "spikes", .apply = add_spikes, .note = "the tool's pose jumps and returns"},
      {.name = "no contact", .apply = remove_contact, .note = "no contact"},
  };
  return all;
}

/// Whether a note contains `part`; an empty one is in every report.
bool has(const std::vector<std::string>& notes, const std::string& part) {
  return part.empty() || std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
           return note.find(part) != std::string::npos;
         });
}

/// The findings of one command.
struct Answer {
  std::string fault;  ///< message with which force or recording were refused
  std::vector<std::string> notes;
  InputFindings inputs;
  bool has_run = false;
};

Answer identified(const IdentificationInput& input) {
  Answer answer;
  const auto found = identify(input, IdentificationGoal::friction);
  answer.has_run = found.has_value();
  if (found) {
    answer.inputs = found->inputs;
    answer.notes = found->notes;
  } else if (found.error().message.find("no contact") != std::string::npos) {
    answer.notes = {found.error().message};
  } else {
    answer.fault = found.error().message;
  }
  return answer;
}

Answer replayed(const IdentificationInput& input) {
  Answer answer;
  const auto run = run_teleop(teleop_input_of(input), {});
  answer.has_run = run.has_value();
  if (!run) {
    answer.fault = run.error().message;
    return answer;
  }
  answer.inputs = run->inputs;
  answer.notes = run->notes;
  if (run->inputs.fault) answer.fault = run->inputs.fault->error.message;
  return answer;
}

/// The fault that a message states, without the evidence behind the colon.
std::string what_of(const std::string& fault) { return fault.substr(0, fault.find(':')); }

class BadInputs : public testing::TestWithParam<std::size_t> {
 protected:
  static const IdentificationInput& sound() {
    static const IdentificationInput input = simulated_input(kDuration);
    return input;
  }
};

TEST_P(BadInputs, GetTheSameAnswerFromBothCommands) {
  const BadInput& row = bad_inputs()[GetParam()];
  SCOPED_TRACE(row.name);
  IdentificationInput input = sound();
  row.apply(input);
  const Answer identify = identified(input);
  const Answer replay = replayed(input);
  // The evidence may differ by a contact: live, a pose that jumps waits for the next one.
  EXPECT_EQ(what_of(identify.fault), what_of(replay.fault));
  EXPECT_NE(identify.fault.find(row.fault), std::string::npos) << identify.fault;
  EXPECT_EQ(identify.fault.empty(), std::string(row.fault).empty()) << identify.fault;
  EXPECT_EQ(replay.has_run, row.is_replayed);
  if (!identify.fault.empty()) {
    EXPECT_TRUE(!replay.has_run || has(replay.notes, "the force is not used")) << row.name;
    return;
  }
  EXPECT_TRUE(has(identify.notes, row.note)) << "note of identify";
  EXPECT_TRUE(has(replay.notes, row.note)) << "note of replay";
  if (!identify.has_run) return;
  EXPECT_DOUBLE_EQ(identify.inputs.force_shift(), replay.inputs.force_shift());
  EXPECT_DOUBLE_EQ(identify.inputs.camera_shift(), replay.inputs.camera_shift());
  EXPECT_NEAR(identify.inputs.force_shift(), row.force_late, 0.003);
  const TimeOffset& camera = identify.inputs.tool_to_camera;
  if (row.camera_late > 0.0) {
    EXPECT_LT(camera.std, 0.010);  // a third of a frame's interval
  }
  EXPECT_NEAR(identify.inputs.camera_shift(), row.camera_late, 3.0 * camera.std);
  EXPECT_EQ(identify.inputs.force_ceiling, replay.inputs.force_ceiling);
  EXPECT_EQ(identify.inputs.tool_outliers, replay.inputs.tool_outliers);
  EXPECT_EQ(identify.inputs.tool_jumps, replay.inputs.tool_jumps);
  EXPECT_EQ(identify.inputs.contacts, replay.inputs.contacts);
}

TEST(TrackingOffset, IsThatOfTheClocksWhereTheTipSlidesAlongATurningObject) {
  IdentificationInput input = identified_case(ToolTask::turn, 804, 14.0).input;
  const Answer sound = identified(input);
  ASSERT_TRUE(sound.has_run);
  EXPECT_TRUE(sound.inputs.tool_to_camera.is_known);
  EXPECT_DOUBLE_EQ(sound.inputs.camera_shift(), 0.0);
  delay_tracking(input);
  const TimeOffset late = identified(input).inputs.tool_to_camera;
  EXPECT_NEAR(late.offset, 0.1, 2.0 * late.std);
  EXPECT_LT(late.std, 0.010);
}

TEST(TrackingOffset, OfOneBodyIsNotThatOfTheOthers) {
  IdentificationInput input = identified_case(ToolTask::push, 7, 40.0).input;
  ASSERT_GE(input.objects.size(), 2U);
  constexpr double kLate = 1.0 / 30.0;
  for (TrackedPose& pose : input.objects[1].tracked) pose.t += kLate;
  const InputSeries series = series_view(input);
  std::vector<Contact> contacts;
  (void)examine_inputs(series, InputOptions(),
                       [&](Contact&& contact) { contacts.push_back(std::move(contact)); });
  const ContactDelays found = contact_delays(series, contacts, InputOptions());
  ASSERT_EQ(found.tracks.size(), 2U);
  for (const TrackDelays& track : found.tracks) {
    ASSERT_TRUE(track.offset.is_known);
    EXPECT_NEAR(track.offset.offset, track.body == 1 ? kLate : 0.0, 3.0 * track.offset.std);
    EXPECT_LT(track.offset.std, 0.010);
    EXPECT_FALSE(find_delay_change(track.contacts).step);
  }
}

/// Every `step`th sample of tool and force.
void thin_out(std::size_t step, IdentificationInput& input) {
  const auto thin = [step](auto& values) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); i += step) values[kept++] = values[i];
    values.resize(kept);
  };
  thin(input.t_tool);
  thin(input.p_base_tip);
  thin(input.q_base_tool);
  thin(input.t_force);
  thin(input.force_base);
}

TEST(TrackingOffset, IsNotFoundWhereSamplesAreTooFewForTheEndsOfSlides) {
  for (const std::uint64_t seed : {2U, 3U, 4U}) {
    for (const std::size_t step : {20U, 33U}) {
      IdentificationInput input = identified_case(ToolTask::push, seed, 14.0).input;
      thin_out(step, input);
      EXPECT_EQ(identified(input).inputs.camera_shift(), 0.0)
          << "seed " << seed << ", " << 500 / step << " Hz";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BadInputs, testing::Range<std::size_t>(0, bad_inputs().size()),
                         [](const auto& row) {
                           std::string name = bad_inputs()[row.param].name;
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name;
                         });

}  // namespace
}  // namespace pcavr
