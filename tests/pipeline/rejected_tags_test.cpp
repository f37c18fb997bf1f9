// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "pcavr/base/geometry/camera.hpp"

#include "pipeline/build/survey.hpp"

namespace pcavr {
namespace {

Recording recording_with_a_base_tag() {
  Recording recording;
  recording.manifest.camera =
      CameraModel{.width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 319.5, .cy = 239.5};
  recording.manifest.markers = {
      {.id = {"tag36h11", 7}, .size = 0.1, .role = MarkerRole::base, .object = {}}};
  return recording;
}

TagDetection detection(const std::array<Eigen::Vector2d, 4>& corners) {
  return {.id = {"tag36h11", 7}, .corners = corners};
}

// A square from its lower left corner on, counter-clockwise.
const TagDetection kSquare =
    detection({Eigen::Vector2d{300, 260}, {340, 260}, {340, 220}, {300, 220}});
// Its third corner lies inside the triangle of the others: no picture of a square.
const TagDetection kConcave =
    detection({Eigen::Vector2d{300, 260}, {340, 260}, {310, 250}, {300, 220}});

TEST(ExplainRejectedTags, NamesTheTagAndHowManyFramesShowItInVain) {
  const std::string reason = explain_rejected_tags(recording_with_a_base_tag(),
                                                   {{kConcave}, {}, {kSquare}, {kConcave}}, "");
  EXPECT_NE(reason.find("tag36h11:7 was seen in 3 frames, but rejected in 2"), reason.npos)
      << reason;
}

TEST(ExplainRejectedTags, IsEmptyWhereEachSightGaveAPoseOrThereWasNone) {
  const Recording recording = recording_with_a_base_tag();
  EXPECT_EQ(explain_rejected_tags(recording, {{kSquare}, {}}, ""), "");
  EXPECT_EQ(explain_rejected_tags(recording, {{}, {}}, ""), "");
  EXPECT_EQ(explain_rejected_tags(recording, {{kConcave}}, "box"), "") << "not a tag of the box";
}

TEST(ExplainNotFound, NamesTagsThatAreInNoFrameOrInViewTwice) {
  const MarkerId lost{"tag36h11", 8};
  const MarkerId copied{"tag36h11", 9};
  DeclaredBody body;
  body.entry.name = "box";
  Survey survey;
  const Recording recording = recording_with_a_base_tag();
  EXPECT_EQ(explain_not_found(recording, survey, body),
            "it has no tag, and no pose in recording.yaml");
  body.tags = {{lost, 0.1, Pose()}, {copied, 0.1, Pose()}};
  survey.tags_seen[copied] = 12;
  survey.copied_tags = {copied};
  EXPECT_EQ(explain_not_found(recording, survey, body),
            "its tag tag36h11:8 is in no frame, tag36h11:9 is in view twice");
}

}  // namespace
}  // namespace pcavr
