// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/checks/tag_copies.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

const MarkerId kFirst{"tag36h11", 0};
const MarkerId kSecond{"tag36h11", 5};

Manifest two_tags() {
  Manifest manifest;
  manifest.markers = {{.id = kFirst, .size = 0.1, .role = MarkerRole::base, .object = {}},
                      {.id = kSecond, .size = 0.1, .role = MarkerRole::object, .object = "box"}};
  return manifest;
}

TagDetection seen(const MarkerId& id) { return {.id = id, .corners = {}}; }

TEST(TagCopies, AreNotUsedInAnyFrameAndAreNamedWithTheirFrames) {
  TagCopies copies;
  for (int frame = 0; frame < 4; ++frame) copies.add({seen(kFirst)}, {kSecond});
  copies.add({seen(kFirst), seen(kSecond)}, {});
  EXPECT_EQ(copies.ids(), std::set<MarkerId>{kSecond});
  const auto findings = copies.findings(two_tags());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].place, "markers[1]");
  EXPECT_NE(findings[0].message.find("tag36h11:5 is seen twice in 4 of the 5 frames"),
            std::string::npos)
      << findings[0].message;
  std::vector<TagDetection> detections{seen(kFirst), seen(kSecond)};
  remove_tags(copies.ids(), detections);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].id, kFirst);
}

TEST(TagCopies, ASingleFalseDetectionCostsItsFrameOnlyAndIsReported) {
  TagCopies copies;
  for (int frame = 0; frame < 20; ++frame) copies.add({seen(kFirst)}, {});
  copies.add({}, {kFirst});
  EXPECT_TRUE(copies.ids().empty());
  const auto findings = copies.findings(two_tags());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].message.find("twice in 1 of the 21 frames"), std::string::npos)
      << findings[0].message;
}

TEST(TagCopies, OfUndeclaredTagsDoNotMatter) {
  TagCopies copies;
  for (int frame = 0; frame < 4; ++frame) copies.add({}, {{"tag36h11", 77}});
  EXPECT_TRUE(copies.findings(two_tags()).empty());
}

}  // namespace
}  // namespace pcavr
