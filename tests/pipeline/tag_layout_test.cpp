// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Tags of one body whose stated poses, or sizes, disagree with the images that show them together.
#include <gtest/gtest.h>

#include "pipeline/checks/consistency_layout.hpp"
#include "pipeline/consistency_case.hpp"

namespace pcavr {
namespace {

constexpr double kCornerStd = 0.05;  // [px]

/// Three base tags on a table, up to 0.9 m apart, in 12 views.
struct LayoutCase {
  Manifest manifest;  ///< as stated
  std::vector<std::vector<TagDetection>> detections;
  std::vector<Pose> T_base_camera;
};

LayoutCase a_layout(std::size_t tags, std::uint64_t seed = 1) {
  LayoutCase made;
  made.manifest.camera =
      CameraModel{.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  const Pose turned(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())),
                    {0.3, -0.3, 0.0});
  const std::vector<MarkerEntry> all{a_tag(0, 0.12, turned),
                                     a_tag(1, 0.12, Pose::from_translation({0.9, 0.3, 0.0})),
                                     a_tag(2, 0.12, Pose::from_translation({0.3, 0.4, 0.0}))};
  made.manifest.markers.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(tags));
  Random random(seed);
  for (int view = 0; view < 12; ++view) {
    const double angle = 0.1 * view - 0.5;
    made.T_base_camera.push_back(
        looking_at({0.6 + 1.2 * std::cos(angle), 1.2 * std::sin(angle), 1.0}, {0.55, 0.05, 0.0}));
    std::vector<TagDetection>& seen = made.detections.emplace_back();
    for (const MarkerEntry& marker : made.manifest.markers) {
      TagDetection detection{.id = marker.id, .corners = {}, .corner_std = kCornerStd};
      const auto corners = tag_corners(marker.size);
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d p =
            made.T_base_camera.back().inverse() * (marker.T_parent_marker * corners[i]);
        detection.corners[i] = made.manifest.camera->project(p) +
                               kCornerStd * Eigen::Vector2d(random.normal(), random.normal());
      }
      seen.push_back(detection);
    }
  }
  return made;
}

std::vector<ConsistencyFinding> findings_of(const LayoutCase& made) {
  return check_tag_layout(made.manifest, compare_tag_pairs(made.manifest, made.detections, 3));
}

void move(Pose& pose, const Eigen::Vector3d& by) {
  pose = Pose(pose.rotation(), pose.translation() + by);
}

TEST(TagLayout, AgreesWhereThePosesAreRightToSomeMillimetres) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    LayoutCase made = a_layout(3, seed);
    move(made.manifest.markers[1].T_parent_marker, {0.001, -0.001, 0.0});
    for (MarkerEntry& marker : made.manifest.markers) marker.size *= 1.005;
    const auto findings = findings_of(made);
    EXPECT_TRUE(findings.empty()) << findings[0].to_string();
  }
}

TEST(TagLayout, NamesBothOfTwoTagsThatAre58MillimetresOff) {
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0.058, 0, 0), Eigen::Vector3d(0, -0.058, 0),
                                    Eigen::Vector3d(0, 0, 0.058)}) {
    LayoutCase made = a_layout(2);
    move(made.manifest.markers[1].T_parent_marker, by);
    const auto findings = findings_of(made);
    ASSERT_EQ(findings.size(), 1U) << by.transpose();
    EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
    EXPECT_EQ(findings[0].place, "markers[0].pose, markers[1].pose");
    EXPECT_NE(findings[0].message.find("tag36h11:0 and tag36h11:1 are 0.8"), std::string::npos)
        << findings[0].message;
  }
}

TEST(TagLayout, NamesTheOneOfThreeTagsThatIsElsewhere) {
  for (std::size_t culprit = 0; culprit < 3; ++culprit) {
    LayoutCase made = a_layout(3);
    move(made.manifest.markers[culprit].T_parent_marker, {0.03, 0.03, 0.0});
    const auto findings = findings_of(made);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].place, "markers[" + std::to_string(culprit) + "].pose");
    EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
  }
}

TEST(TagLayout, RecognisesAQuaternionThatBeginsWithW) {
  LayoutCase made = a_layout(2);
  const Eigen::Quaterniond q = made.manifest.markers[0].T_parent_marker.rotation();
  made.manifest.markers[0].T_parent_marker =
      Pose(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()),
           made.manifest.markers[0].T_parent_marker.translation());
  const auto findings = findings_of(made);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
  EXPECT_NE(findings[0].hint.find("markers[0].pose fits with its quaternion read as w x y z"),
            std::string::npos)
      << findings[0].hint;
}

TEST(TagLayout, RejectsATagOfTwiceItsSizeWithoutDepth) {
  LayoutCase made = a_layout(2);
  made.manifest.markers[1].size *= 2.0;
  const auto findings = findings_of(made);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
}

TEST(TagLayout, WidensTheCamerasStdsByWhatTheTagsLeaveOpen) {
  for (const double off : {0.0, 0.003, 0.01}) {
    LayoutCase made = a_layout(2);
    move(made.manifest.markers[1].T_parent_marker, {0.0, off, 0.0});
    const std::vector<TagPlacement> placements = base_placements(made.manifest);
    CameraTrack track;
    std::vector<double> errors;
    for (std::size_t i = 0; i < made.detections.size(); ++i) {
      const BodyPose base = solve_body_pose(placements, made.detections[i], *made.manifest.camera);
      FramePlacement frame;
      frame.status = PlacementStatus::placed;
      frame.T_base_camera = base.pose.T_camera_body.inverse();
      Eigen::Matrix<double, 3, 6> by_twist;
      by_twist << Eigen::Matrix3d::Identity(), -skew(frame.T_base_camera.translation());
      frame.position_std = std::sqrt((by_twist * base.covariance * by_twist.transpose()).trace());
      track.frames.push_back(frame);
      errors.push_back(translation_distance(frame.T_base_camera, made.T_base_camera[i]));
    }
    widen_by_layout(made.manifest, compare_tag_pairs(made.manifest, made.detections, 3), track);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      EXPECT_LT(errors[i], 3.0 * track.frames[i].position_std) << off;
    }
    EXPECT_LT(track.frames[0].position_std, 0.006 + 3.0 * off) << off;
  }
}

}  // namespace
}  // namespace pcavr
