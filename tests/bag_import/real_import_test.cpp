// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// The rows of a CSV file without its header and first column: stamp, then numbers; by stamp.
std::vector<std::pair<Stamp, std::vector<double>>> reference_rows(const std::string& name) {
  std::vector<std::pair<Stamp, std::vector<double>>> rows;
  const auto text = read_file(shared_data("real/push_mit/Al_block/Test_metal_1_" + name + ".csv"));
  std::istringstream lines(text ? *text : std::string());
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string field;
    std::getline(fields, field, ',');
    std::getline(fields, field, ',');
    auto& [stamp, numbers] = rows.emplace_back(*parse_stamp(field), std::vector<double>());
    while (std::getline(fields, field, ',')) numbers.push_back(std::stod(field));
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// The CSV files have stamps from doubles, to 0.3 us, and numbers with nine decimals.
void expect_row(const std::pair<Stamp, std::vector<double>>& row, Stamp stamp,
                const std::vector<double>& numbers) {
  EXPECT_LT(std::abs(to_seconds(stamp - row.first)), 3e-7);
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_NEAR(numbers[i], row.second[i], 6e-10);
}

void expect_poses(const std::string& reference, const Trajectory& trajectory) {
  const auto rows = reference_rows(reference);
  ASSERT_EQ(trajectory.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [stamp, pose] = trajectory.poses()[i];
    const Eigen::Vector3d& p = pose.translation();
    const Eigen::Quaterniond& q = pose.rotation();
    expect_row(rows[i], stamp, {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
  }
}

/// A real push, of which the numbers were extracted by other means.
TEST(RealImport, ThePushIsThatOfItsCsvFiles) {
  PCAVR_NEEDS_SHARED_DATA("real/bags");
  PCAVR_NEEDS_SHARED_DATA("real/push_mit");
  const TemporaryFolder folder;
  BagImportOptions options;
  options.topics.wrench_topic = "netft_data";
  options.topics.base_frame = "/world";  // the tracker's, so that nothing is transformed
  options.topics.wrench_frame = "world";
  const auto report =
      import_bag(shared_data("real/bags/ros1/Test_metal_1.bag"), folder.path(), options);
  ASSERT_TRUE(report) << report.error().to_string();
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording) << recording.error().to_string();
  expect_poses("tip", recording->tool);
  const auto box = read_trajectory(folder.path() / "tracked/objects/MetalSquare/tracked.txt");
  ASSERT_TRUE(box);
  expect_poses("obj", *box);
  const auto forces = reference_rows("ft");
  ASSERT_EQ(recording->wrench.size(), forces.size());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const WrenchSample& s = recording->wrench[i];
    expect_row(forces[i], s.stamp,
               {s.force.x(), s.force.y(), s.force.z(), s.torque.x(), s.torque.y(), s.torque.z()});
  }
}

/// Tip and block stay 63 to 68 mm apart in the plane of the table while it is pushed, through the
/// chain base_link, map, viconworld, world; to a clock error of 10 ms at 0.15 m/s.
TEST(RealImport, TfBringsTipAndBlockTogether) {
  PCAVR_NEEDS_SHARED_DATA("real/bags");
  const TemporaryFolder folder;
  const auto report = import_bag(shared_data("real/bags/ros1/Test_metal_1.bag"), folder.path(), {});
  ASSERT_TRUE(report) << report.error().to_string();
  EXPECT_EQ(report->base_frame, "base_link");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording);
  const auto box = read_trajectory(folder.path() / "tracked/objects/MetalSquare/tracked.txt");
  ASSERT_TRUE(box);
  for (const TimedPose& tip : recording->tool.poses()) {
    const double t = to_seconds(tip.stamp - recording->tool.poses().front().stamp);
    if (t > 2.5) break;  // the push ends later
    const std::optional<Pose> block = box->at(tip.stamp);
    ASSERT_TRUE(block);
    const double distance = (tip.pose.translation() - block->translation()).head<2>().norm();
    EXPECT_GT(distance, 0.063 - 0.0015);
    EXPECT_LT(distance, 0.068 + 0.0015);
  }
}

TEST(RealImport, WrongSerializationIsAnError) {
  PCAVR_NEEDS_SHARED_DATA("real/bags");
  const auto survey = survey_bag(shared_data("real/bags/rosbag2_samples/mcap/wrong_rmw_test"));
  ASSERT_FALSE(survey);
  EXPECT_NE(survey.error().message.find("'wrong_format'"), std::string::npos);
}

/// Ten pushes of a steel block of 100 mm, with motion capture in its own frame.
TEST(RealImport, HalvesOfRawRunsFindOneWorld) {
  PCAVR_NEEDS_SHARED_DATA("real/push_mit/St_block");
  const auto run = [](int i) {
    return shared_data("real/push_mit/St_block/Test_st_" + std::to_string(i));
  };
  BagImportOptions options;
  options.topics.tool_topic = "tip";
  options.topics.wrench_topic = "ft";
  options.topics.wrench_frame = "tool";
  options.topics.objects = {{"block", "obj"}};
  options.invert_wrench = true;
  options.tare = 0.2;
  options.p_tool_tip.z() = 0.16;
  options.pushed_sides = PushedSides{
      .outline_object = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}},
      .middle_object = 0.0065,
      .tip_radius = 0.00475};
  std::vector<WorldPlacement> worlds;
  for (const int first : {1, 6}) {
    const TemporaryFolder folder;
    options.world_bags = {run(first + 1), run(first + 2), run(first + 3), run(first + 4)};
    const auto report = import_bag(run(first), folder.path(), options);
    ASSERT_TRUE(report) << report.error().to_string();
    worlds.push_back(report->world.value());
    EXPECT_LT(worlds.back().residual, 0.001);
    EXPECT_NEAR(worlds.back().tool_delay, 0.02, 0.005);
  }
  const Pose difference = worlds[0].T_base_world.inverse() * worlds[1].T_base_world;
  EXPECT_LT(difference.translation().norm(), 0.002);
  EXPECT_LT(difference.log().tail<3>().norm(), 0.005);
}

}  // namespace
}  // namespace pcavr
