// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_detector.hpp"

#include <gtest/gtest.h>

#include "marker/tag_rendering.hpp"

namespace pcavr {
namespace {

using test::a_camera;
using test::facing;
using test::render_tags;
using test::RenderedTag;
using test::true_corners;

TagDetector a_detector(const std::string& family, const TagDetectorOptions& options = {}) {
  auto detector = TagDetector::create({family}, options);
  return std::move(*detector);
}

double squared_corner_error(const TagDetection& detection, const RenderedTag& tag,
                            const CameraModel& camera) {
  const auto expected = true_corners(tag, camera);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += (detection.corners[i] - expected[i]).squaredNorm();
  return sum;
}

/// A pose like that of a tag on a table: 0.4 to 1.2 m away, up to 60 degrees oblique.
RenderedTag a_random_tag(Random& random) {
  const Eigen::Vector3d p_camera(random.uniform(-0.1, 0.1), random.uniform(-0.08, 0.08),
                                 random.uniform(0.4, 1.2));
  return {{"tag36h11", static_cast<int>(random.below(100))},
          0.12,
          facing(p_camera, random.uniform(0.0, 1.05), random.uniform(0, 6.28),
                 random.uniform(0, 6.28))};
}

TEST(TagDetector, PlacesCornersWithinAFewHundredthsOfAPixel) {
  const CameraModel camera = a_camera();
  Random random(1);
  double sum = 0.0;
  double variance = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  const int count = 30;
  for (int i = 0; i < count; ++i) {
    const RenderedTag tag = a_random_tag(random);
    const auto found = a_detector("tag36h11").detect(render_tags({tag}, camera, random.bits()));
    ASSERT_EQ(found.size(), 1U) << i;
    EXPECT_EQ(found[0].id, tag.id);
    sum += squared_corner_error(found[0], tag, camera) / (8.0 * count);
    variance += found[0].corner_std * found[0].corner_std / count;
    for (std::size_t k = 0; k < 4; ++k) {
      mean += (found[0].corners[k] - true_corners(tag, camera)[k]) / (4.0 * count);
    }
  }
  RecordProperty("corner_rms_px", std::to_string(std::sqrt(sum)));
  EXPECT_LT(std::sqrt(sum), 0.04);  // [px]; libapriltag's own reach 0.06 to 0.1 here
  EXPECT_LT(mean.norm(), 0.01);     // no bias, such as the half pixel between the conventions
  // The stated standard deviation is neither too small nor too large.
  EXPECT_LT(std::sqrt(sum), 2.0 * std::sqrt(variance));
  EXPECT_GT(std::sqrt(sum), 0.5 * std::sqrt(variance));
}

TEST(TagDetector, ConvertsFromTheLibrarysMarkerFrame) {
  const CameraModel camera = a_camera();
  const RenderedTag upright{{"tag36h11", 7}, 0.1, facing({0, 0, 0.6}, 0, 0, 0)};
  const auto found = a_detector("tag36h11").detect(render_tags({upright}, camera));
  ASSERT_EQ(found.size(), 1U);
  // Seen upright: the first corner is bottom left, the second bottom right, then counter-clockwise.
  const auto& c = found[0].corners;
  EXPECT_LT(c[0].x(), 319.5);
  EXPECT_GT(c[0].y(), 239.5);
  EXPECT_GT(c[1].x(), 319.5);
  EXPECT_GT(c[1].y(), 239.5);
  EXPECT_GT(c[2].x(), 319.5);
  EXPECT_LT(c[2].y(), 239.5);
}

TEST(TagDetector, FindsTagsOfEveryFamilyWhereTheyAre) {
  const CameraModel camera = a_camera();
  for (const std::string& family : tag_families()) {
    const double size = family.starts_with("tagS") || family.starts_with("tagC") ? 0.07 : 0.12;
    const RenderedTag tag{{family, 5}, size, facing({0.02, -0.01, 0.5}, 0.5, 1.0, 0.3)};
    const auto found = a_detector(family).detect(render_tags({tag}, camera));
    ASSERT_EQ(found.size(), 1U) << family;
    EXPECT_EQ(found[0].id, tag.id);
    EXPECT_EQ(found[0].hamming, 0) << family;
    EXPECT_LT(std::sqrt(squared_corner_error(found[0], tag, camera) / 8.0), 0.05) << family;
  }
}

TEST(TagDetector, CorrectsLensDistortionIfGiven) {
  const CameraModel camera = a_camera(-0.25);
  const RenderedTag tag{{"tag36h11", 3}, 0.12, facing({0.13, 0.09, 0.4}, 0.2, 0.5, 0.1)};
  const GrayImage image = render_tags({tag}, camera);
  TagDetectorOptions options;
  options.lens = camera;
  const auto with = a_detector("tag36h11", options).detect(image);
  const auto without = a_detector("tag36h11").detect(image);
  ASSERT_EQ(with.size(), 1U);
  ASSERT_EQ(without.size(), 1U);
  const double error_with = std::sqrt(squared_corner_error(with[0], tag, camera) / 8.0);
  const double error_without = std::sqrt(squared_corner_error(without[0], tag, camera) / 8.0);
  EXPECT_LT(error_with, 0.05);  // [px], as without a lens
  EXPECT_GT(error_without, 2.0 * error_with);
}

TEST(TagDetector, FindsATagThatComesIntoViewAtTheNextFullSearch) {
  const CameraModel camera = a_camera();
  const RenderedTag first{{"tag36h11", 1}, 0.08, facing({-0.2, 0, 0.8}, 0.3, 0, 0)};
  const RenderedTag second{{"tag36h11", 2}, 0.08, facing({0.3, 0.2, 0.8}, 0.3, 0, 0)};
  const GrayImage before = render_tags({first}, camera);
  const GrayImage after = render_tags({first, second}, camera);
  TagDetector detector = a_detector("tag36h11");
  EXPECT_EQ(detector.detect(before).size(), 1U);
  int frames = 1;
  while (detector.detect(after).size() < 2U && frames < 20) ++frames;
  EXPECT_EQ(frames, TagDetectorOptions{}.full_search_interval);
}

TEST(TagDetector, FindsTheSameTagsInRegionsAsInAFullSearch) {
  const CameraModel camera = a_camera();
  TagDetector tracking = a_detector("tag36h11");
  for (int frame = 0; frame < 6; ++frame) {
    const double x = -0.15 + 0.05 * frame;  // 31 px a frame
    const RenderedTag tag{{"tag36h11", 1}, 0.08, facing({x, 0, 0.85}, 0.4, 0.1 * frame, 0)};
    const GrayImage image = render_tags({tag}, camera);
    const auto near = tracking.detect(image);
    const auto full = a_detector("tag36h11").detect(image);
    ASSERT_EQ(near.size(), 1U) << frame;
    ASSERT_EQ(full.size(), 1U) << frame;
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT((near[0].corners[k] - full[0].corners[k]).norm(), 2e-3);  // [px]
    }
  }
}

TEST(TagDetector, SearchesTheWholeImageWhenATagHasJumped) {
  const CameraModel camera = a_camera();
  const RenderedTag left{{"tag36h11", 1}, 0.08, facing({-0.3, -0.2, 0.8}, 0.3, 0, 0)};
  const RenderedTag right{{"tag36h11", 1}, 0.08, facing({0.3, 0.2, 0.8}, 0.3, 0, 0)};
  TagDetector detector = a_detector("tag36h11");
  EXPECT_EQ(detector.detect(render_tags({left}, camera)).size(), 1U);
  EXPECT_EQ(detector.detect(render_tags({right}, camera)).size(), 1U);
}

TEST(TagDetector, SortsByIdAndReportsEachTagOnce) {
  const CameraModel camera = a_camera();
  const std::vector<RenderedTag> tags{
      {{"tag36h11", 9}, 0.08, facing({-0.2, 0, 0.8}, 0.3, 0, 0)},
      {{"tag36h11", 2}, 0.08, facing({0.0, 0, 0.8}, 0.3, 0, 0)},
      {{"DICT_6X6_250", 4}, 0.08, facing({0.0, 0.15, 0.8}, 0.3, 0, 0)}};
  auto detector = TagDetector::create({"tag36h11", "DICT_6X6_250", "tag36h11"});
  const auto found = detector->detect(render_tags(tags, camera));
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].id.to_string(), "DICT_6X6_250:4");
  EXPECT_EQ(found[1].id.to_string(), "tag36h11:2");
  EXPECT_EQ(found[2].id.to_string(), "tag36h11:9");
}

TEST(TagDetector, LeavesOutAnIdThatIsInTheImageTwiceAndReportsIt) {
  const CameraModel camera = a_camera();
  const RenderedTag other{{"tag36h11", 9}, 0.08, facing({-0.2, 0, 0.8}, 0.3, 0, 0)};
  for (const std::string family : {"tag36h11", "DICT_6X6_250"}) {
    // One of the copies is smaller, and its contrast is lower.
    const RenderedTag one{{family, 2}, 0.08, facing({0.0, 0, 0.8}, 0.3, 0, 0)};
    const RenderedTag copy{{family, 2}, 0.05, facing({0.2, 0, 0.8}, 0.9, 0.4, 0)};
    auto detector = TagDetector::create({"tag36h11", "DICT_6X6_250"});
    const auto found = detector->detect(render_tags({other, one, copy}, camera));
    ASSERT_EQ(found.size(), 1U) << family;
    EXPECT_EQ(found[0].id, other.id);
    ASSERT_EQ(detector->seen_twice().size(), 1U) << family;
    EXPECT_EQ(detector->seen_twice()[0], one.id);
    // The next image has one of them only: the detector itself remembers no copies.
    EXPECT_EQ(detector->detect(render_tags({other, one}, camera)).size(), 2U) << family;
    EXPECT_TRUE(detector->seen_twice().empty()) << family;
  }
}

TEST(TagDetector, FindsBothCopiesWhereItSearchesRegionsOnly) {
  const CameraModel camera = a_camera();
  const GrayImage image = render_tags({{{"tag36h11", 2}, 0.08, facing({-0.2, 0, 0.8}, 0.3, 0, 0)},
                                       {{"tag36h11", 2}, 0.08, facing({0.2, 0.1, 0.8}, 0.3, 0, 0)}},
                                      camera);
  TagDetector detector = a_detector("tag36h11");
  for (int frame = 0; frame < TagDetectorOptions{}.full_search_interval + 2; ++frame) {
    EXPECT_TRUE(detector.detect(image).empty()) << frame;
    EXPECT_EQ(detector.seen_twice().size(), 1U) << frame;
  }
}

TEST(TagDetector, AcceptsEmptyImages) {
  TagDetector detector = a_detector("tag36h11");
  EXPECT_TRUE(detector.detect(GrayImage()).empty());
  EXPECT_TRUE(detector.detect(GrayImage(1, 1, 7)).empty());
  EXPECT_TRUE(detector.detect(GrayImage(9, 5, 7)).empty());
  EXPECT_TRUE(detector.detect(GrayImage(640, 480, 0)).empty());
}

TEST(TagDetector, IgnoresATagThatIsPartlyOutsideTheImage) {
  const CameraModel camera = a_camera();
  const RenderedTag cut{{"tag36h11", 1}, 0.12, facing({-0.35, 0, 0.6}, 0.2, 0, 0)};
  ASSERT_LT(true_corners(cut, camera)[0].x(), 0.0);
  EXPECT_TRUE(a_detector("tag36h11").detect(render_tags({cut}, camera)).empty());
}

TEST(TagDetector, IsRobustToAThumbThatCoversPartOfAnEdge) {
  const CameraModel camera = a_camera();
  const RenderedTag tag{{"tag36h11", 1}, 0.12, facing({0, 0, 0.5}, 0.3, 0.4, 0)};
  GrayImage image = render_tags({tag}, camera);
  const auto corners = true_corners(tag, camera);
  const Eigen::Vector2d middle = 0.5 * (corners[0] + corners[1]);
  for (int y = -5; y <= 5; ++y) {
    for (int x = -5; x <= 5; ++x) image(int(middle.x()) + x, int(middle.y()) + y) = 110;
  }
  const auto found = a_detector("tag36h11").detect(image);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(std::sqrt(squared_corner_error(found[0], tag, camera) / 8.0), 0.15);  // [px]
}

TEST(TagDetector, ListsTheSupportedFamiliesIfOneIsUnknown) {
  const auto detector = TagDetector::create({"tag36h12"});
  ASSERT_FALSE(detector.has_value());
  EXPECT_NE(detector.error().message.find("tag36h12"), std::string::npos);
  EXPECT_NE(detector.error().hint.find("tag36h11"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
