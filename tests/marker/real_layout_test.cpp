// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Layouts from the corners of a hand-held camera, against those that TagSLAM found.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "pcavr/perception/marker/tag_layout.hpp"

#include "marker/tagslam_data.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

constexpr double kMaxOffset = 5e-3;                            // [m] of TagSLAM's own
constexpr double kMaxRotation = 0.5 * std::numbers::pi / 180;  // [rad]

std::vector<std::vector<TagDetection>> detections_of(const std::vector<CornerFrame>& frames) {
  std::vector<std::vector<TagDetection>> detections;
  for (const CornerFrame& frame : frames) detections.push_back(frame.detections);
  return detections;
}

/// The body's tags, the first with its pose, the others without.
std::vector<LayoutTag> with_first_given(const std::vector<TagPlacement>& placements) {
  std::vector<LayoutTag> tags;
  for (const TagPlacement& placement : placements) {
    tags.push_back({.id = placement.id, .size = placement.size});
  }
  tags.front().T_body_tag = placements.front().T_body_marker;
  return tags;
}

/// Compares with TagSLAM's tags, after the bodies' frames are brought together at one tag.
void expect_layout(const TagLayout& found, const std::vector<TagPlacement>& expected) {
  ASSERT_EQ(found.tags.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const LaidOutTag& tag = found.tags[i];
    const double offset = translation_distance(tag.T_body_tag, expected[i].T_body_marker);
    const double rotation = rotation_distance(tag.T_body_tag, expected[i].T_body_marker);
    std::printf("  tag %3d: %.2f mm, %.2f deg from TagSLAM's; std %.2f mm, %.2f deg; %zu views\n",
                tag.id.id, 1e3 * offset, 180.0 / std::numbers::pi * rotation,
                1e3 * tag.position_std(), 180.0 / std::numbers::pi * tag.rotation_std(), tag.views);
    EXPECT_LT(offset, kMaxOffset) << tag.id.id;
    EXPECT_LT(rotation, kMaxRotation) << tag.id.id;
  }
}

TEST(RealLayout, AgreesWithTagSlamOnTheTagsOfARoom) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_18");
  const auto folder = shared_data("real/tagslam/test_18");
  const auto frames = detections_of(read_corners(folder / "detections.csv"));
  const auto lab = read_body(folder / "tagslam.yaml", "lab");
  const auto found = solve_tag_layout(with_first_given(lab), frames, tagslam_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  expect_layout(*found, lab);
}

TEST(RealLayout, AgreesWithTagSlamOnTheTagsOfABlock) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_18");
  const auto folder = shared_data("real/tagslam/test_18");
  const auto frames = detections_of(read_corners(folder / "detections.csv"));
  const auto block = read_body(folder / "tagslam.yaml", "block");
  const auto found = solve_tag_layout(with_first_given(block), frames, tagslam_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  expect_layout(*found, block);
}

/// TagSLAM's poses of the rig in its map, by the text of the stamp.
std::map<std::string, Pose> read_rig_poses(const std::filesystem::path& file) {
  std::map<std::string, Pose> poses;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<std::string> fields;
    std::istringstream row(line);
    for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
    const auto number = [&](std::size_t i) { return std::stod(fields.at(i)); };
    poses[fields[0]] = Pose(Eigen::Quaterniond(number(10), number(7), number(8), number(9)),
                            {number(4), number(5), number(6)});
  }
  return poses;
}

TEST(RealLayout, PlacesACameraAsTagSlamDoesByFiveTagsOfWhichOneIsGiven) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_16");
  const auto folder = shared_data("real/tagslam/test_16");
  const auto corners = read_corners(folder / "detections.csv");
  std::vector<LayoutTag> tags;
  for (int id = 0; id < 5; ++id) tags.push_back({.id = {"tag36h11", id}, .size = 0.16});
  Vector6d turn = Vector6d::Zero();
  turn[3] = 1.571;
  tags[2].T_body_tag = Pose::from_translation({0.0, 0.0, 2.0}) * Pose::exp(turn);  // tagslam.yaml
  const auto found = solve_tag_layout(tags, detections_of(corners), tagslam_camera());
  ASSERT_TRUE(found) << found.error().to_string();
  ASSERT_EQ(found->tags.size(), 5U);

  turn[3] = -1.571;
  const Pose T_rig_camera = Pose::from_translation({0.1, 0.0, 0.0}) * Pose::exp(turn);
  const auto reference = read_rig_poses(folder / "reference_odom.csv");
  std::vector<double> offsets, rotations;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto rig = reference.find(corners[i].stamp);
    if (rig == reference.end() || !found->T_body_camera[i]) continue;
    const Pose T_map_camera = rig->second * T_rig_camera;
    offsets.push_back(translation_distance(T_map_camera, *found->T_body_camera[i]));
    rotations.push_back(rotation_distance(T_map_camera, *found->T_body_camera[i]));
  }
  ASSERT_GT(offsets.size(), 200U);
  std::sort(offsets.begin(), offsets.end());
  std::sort(rotations.begin(), rotations.end());
  const double offset = offsets[offsets.size() / 2], rotation = rotations[rotations.size() / 2];
  std::printf("  camera, median of %zu: %.2f mm, %.2f deg from TagSLAM's; largest %.2f mm\n",
              offsets.size(), 1e3 * offset, 180.0 / std::numbers::pi * rotation,
              1e3 * offsets.back());
  EXPECT_LT(offset, kMaxOffset);
  EXPECT_LT(rotation, kMaxRotation);
}

}  // namespace
}  // namespace pcavr
