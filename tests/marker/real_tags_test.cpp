// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pcavr/perception/marker/body_pose.hpp"

#include "marker/tagslam_data.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

GrayImage read_gray(const std::filesystem::path& file) {
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  GrayImage image(picture.cols, picture.rows);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) image(x, y) = picture.at<std::uint8_t>(y, x);
  }
  return image;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

// ---- A photograph of a sheet with twelve tags, compared with another detector's results.

struct ReferenceTag {
  std::array<Eigen::Vector2d, 4> corners;
  Eigen::Vector3d p_camera;
};

std::map<int, ReferenceTag> read_reference(const std::filesystem::path& folder) {
  std::map<int, ReferenceTag> tags;
  std::ifstream corners(folder / "ground_truth_detection.txt");
  std::ifstream poses(folder / "ground_truth_pose.txt");
  std::string name;
  while (corners >> name) {
    ReferenceTag& tag = tags[std::stoi(name.substr(name.rfind('_') + 1))];
    // Written by a program with libapriltag's convention: pixel centres are at 0.5.
    for (Eigen::Vector2d& corner : tag.corners) {
      corners >> corner.y() >> corner.x();
      corner -= Eigen::Vector2d(0.5, 0.5);
    }
  }
  Eigen::Vector3d theta_u;
  while (poses >> name) {
    Eigen::Vector3d& p = tags[std::stoi(name.substr(name.rfind('_') + 1))].p_camera;
    poses >> p.x() >> p.y() >> p.z() >> theta_u.x() >> theta_u.y() >> theta_u.z();
  }
  return tags;
}

TEST(RealTags, AgreeWithAnotherDetectorOnAPhotograph) {
  PCAVR_NEEDS_SHARED_DATA("real/apriltag_photo");
  const auto folder = shared_data("real/apriltag_photo");
  const auto reference = read_reference(folder);
  const CameraModel camera{.width = 640,
                           .height = 480,
                           .fx = 615.1674805,
                           .fy = 615.1675415,
                           .cx = 312.1889954,
                           .cy = 243.4373779};
  const auto found = TagDetector::create({"tag36h11"})->detect(read_gray(folder / "AprilTag.png"));
  ASSERT_EQ(found.size(), 12U);
  std::vector<double> distances;
  std::vector<Eigen::Vector3d> normals;
  int solved = 0;
  for (const TagDetection& tag : found) {
    ASSERT_TRUE(reference.contains(tag.id.id));
    const ReferenceTag& expected = reference.at(tag.id.id);
    for (const Eigen::Vector2d& corner : tag.corners) {
      double nearest = 1e9;
      for (const Eigen::Vector2d& one : expected.corners) {
        nearest = std::min(nearest, (one - corner).norm());
      }
      distances.push_back(nearest);
    }
    const BodyPose pose = solve_body_pose({{tag.id, 0.053, Pose()}}, {tag}, camera);
    if (pose.status == BodyPoseStatus::solved) ++solved;
    EXPECT_LT((pose.pose.T_camera_body.translation() - expected.p_camera).norm(), 0.005);
    normals.push_back(pose.pose.T_camera_body.rotation() * Eigen::Vector3d::UnitZ());
  }
  RecordProperty("corner_median_px", std::to_string(percentile(distances, 0.5)));
  RecordProperty("corner_max_px", std::to_string(percentile(distances, 1.0)));
  EXPECT_LT(percentile(distances, 0.5), 0.2);  // [px]; the reference is no better
  EXPECT_LT(percentile(distances, 1.0), 0.5);
  EXPECT_GE(solved, 9);  // the others are ambiguous, as one small tag may be
  // They lie on one sheet: the wrong planar solution would have another normal.
  for (const Eigen::Vector3d& normal : normals) {
    EXPECT_GT(normal.dot(normals.front()), std::cos(0.2));
  }
}

// ---- Corner streams: a hand-held camera in front of static tags, and a tumbling block with ten.

/// Results of a body over a stream, with the last solved pose as the hint of each frame.
struct StreamResult {
  std::vector<double> reprojection;    ///< [px], of solved poses
  std::vector<double> rotation_rates;  ///< [rad/s], from one solved pose to the next
  int solved = 0;
  int ambiguous = 0;
  int failed = 0;
};

StreamResult track_body(const std::vector<CornerFrame>& frames,
                        const std::vector<TagPlacement>& placements, bool with_hints) {
  StreamResult result;
  std::optional<Pose> last;
  double last_time = 0.0;
  for (const CornerFrame& frame : frames) {
    BodyPoseHints hints;
    if (with_hints) hints.T_camera_body = last;
    const BodyPose found = solve_body_pose(placements, frame.detections, tagslam_camera(), hints);
    if (found.status == BodyPoseStatus::ambiguous) ++result.ambiguous;
    if (found.status == BodyPoseStatus::failed) ++result.failed;
    const std::optional<Pose> before = last;
    last.reset();
    if (found.status != BodyPoseStatus::solved) continue;
    ++result.solved;
    last = found.pose.T_camera_body;
    result.reprojection.push_back(found.pose.reprojection_rms);
    const double time = std::stod(frame.stamp);
    if (before)
      result.rotation_rates.push_back(rotation_distance(*before, *last) / (time - last_time));
    last_time = time;
  }
  return result;
}

void record(const std::string& name, const StreamResult& result) {
  std::ostringstream text;
  text << "solved " << result.solved << " ambiguous " << result.ambiguous << " failed "
       << result.failed << " rms px 50/95/100 % " << percentile(result.reprojection, 0.5) << ' '
       << percentile(result.reprojection, 0.95) << ' ' << percentile(result.reprojection, 1.0)
       << " rotation rad/s 50/95/100 % " << percentile(result.rotation_rates, 0.5) << ' '
       << percentile(result.rotation_rates, 0.95) << ' ' << percentile(result.rotation_rates, 1.0);
  testing::Test::RecordProperty(name, text.str());
}

TEST(RealTags, HaveNoFlipWithACameraInFrontOfStaticTags) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_18");
  const auto folder = shared_data("real/tagslam/test_18");
  const auto frames = read_corners(folder / "detections.csv");
  const auto lab = read_body(folder / "tagslam.yaml", "lab");
  ASSERT_EQ(lab.size(), 4U);
  for (const bool with_hints : {false, true}) {
    const StreamResult result = track_body(frames, lab, with_hints);
    record(with_hints ? "lab_with_hints" : "lab", result);
    EXPECT_GT(result.solved, 866);  // frames with two of them at least
    EXPECT_LT(percentile(result.reprojection, 0.95), 2.0);
    // A hand-held camera rotates slowly; a flip would be tens of degrees in the 25 ms between
    // frames.
    EXPECT_LT(percentile(result.rotation_rates, 1.0), 2.0);
  }
}

TEST(RealTags, HaveNoFlipOnATumblingBlock) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_18");
  const auto folder = shared_data("real/tagslam/test_18");
  const auto frames = read_corners(folder / "detections.csv");
  const auto block = read_body(folder / "tagslam.yaml", "block");
  ASSERT_EQ(block.size(), 10U);
  for (const bool with_hints : {false, true}) {
    const StreamResult result = track_body(frames, block, with_hints);
    record(with_hints ? "block_with_hints" : "block", result);
    EXPECT_GT(result.solved, 700);
    EXPECT_LT(percentile(result.reprojection, 0.95), 2.1);
    // Thrown by hand, the block spins at 13 to 17 rad/s for many frames on end; the other
    // planar solution of a tag seen at 20 degrees is 0.7 rad off, 28 rad/s.
    EXPECT_LT(percentile(result.rotation_rates, 1.0), 22.0);
  }
}

TEST(RealTags, HaveNoFlipWithOnlyOneVisibleTag) {
  PCAVR_NEEDS_SHARED_DATA("real/tagslam/test_16");
  const auto folder = shared_data("real/tagslam/test_16");
  const auto frames = read_corners(folder / "detections.csv");
  for (int id = 0; id < 5; ++id) {
    const StreamResult result = track_body(frames, {{{"tag36h11", id}, 0.16, Pose()}}, true);
    record("tag_" + std::to_string(id), result);
    ASSERT_GT(result.solved, 0) << id;
    EXPECT_LT(percentile(result.reprojection, 0.95), 1.0) << id;
    // A flip of 0.3 rad would be 3 rad/s at the 10 Hz of this camera.
    EXPECT_LT(percentile(result.rotation_rates, 1.0), 2.5) << id;
  }
}

// ---- A board of twelve ArUco tags in front of a depth camera.

std::vector<TagPlacement> charuco_board() {
  // Squares of 80 mm with tags of 60 mm in the white ones, row by row; the top left one is black.
  std::vector<TagPlacement> placements;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 5; ++column) {
      if ((row + column) % 2 == 0) continue;
      const int id = static_cast<int>(placements.size());
      placements.push_back(
          {{"DICT_6X6_250", id}, 0.060, Pose::from_translation({0.08 * column, -0.08 * row, 0.0})});
    }
  }
  return placements;
}

DepthImage read_depth(const std::filesystem::path& file) {
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  DepthImage depth(picture.cols, picture.rows);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      depth(x, y) = 1e-3F * static_cast<float>(picture.at<std::uint16_t>(y, x));
    }
  }
  return depth;
}

TEST(RealTags, FindAllTagsOfABoardAndAgreeWithItsDepth) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_charuco");
  const auto folder = shared_data("real/franka_charuco");
  const CameraModel camera{.width = 1920,
                           .height = 1080,
                           .fx = 1363.7733154296875,
                           .fy = 1361.5714111328125,
                           .cx = 956.2984619140625,
                           .cy = 546.5812377929688};
  auto detector = TagDetector::create({"DICT_6X6_250"});
  for (const char* view : {"01", "08", "15", "22", "29", "36"}) {
    const auto found =
        detector->detect(read_gray(folder / ("color_" + std::string(view) + ".png")));
    EXPECT_EQ(found.size(), 12U) << view;
    const DepthImage depth = read_depth(folder / ("depth_" + std::string(view) + ".png"));
    BodyPoseHints hints;
    hints.depth = &depth;
    const BodyPose corners_only = solve_body_pose(charuco_board(), found, camera);
    const BodyPose pose = solve_body_pose(charuco_board(), found, camera, hints);
    ASSERT_EQ(pose.status, BodyPoseStatus::solved) << view;
    RecordProperty("view_" + std::string(view), std::to_string(pose.tags_used) + " used, rms px " +
                                                    std::to_string(pose.pose.reprojection_rms));
    EXPECT_GE(pose.tags_used, 11) << view;
    EXPECT_LT(pose.pose.reprojection_rms, 1.6) << view;  // without a lens model: 0.85 to 1.4
    // The depth camera has a bias of up to 4 mm there, which does not bias twelve tags.
    EXPECT_LT(translation_distance(pose.pose.T_camera_body, corners_only.pose.T_camera_body), 0.004)
        << view;
    for (const TagPlacement& tag : charuco_board()) {
      const Eigen::Vector3d p_camera = pose.pose.T_camera_body * tag.T_body_marker.translation();
      const Eigen::Vector2d pixel = camera.project(p_camera);
      const float z =
          depth(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      if (z > 0.0F) {
        EXPECT_NEAR(static_cast<double>(z), p_camera.z(), 0.015) << view;
      }
    }
  }
}

}  // namespace
}  // namespace pcavr
