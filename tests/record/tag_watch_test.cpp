// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/record/tag_watch.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "marker/tag_rendering.hpp"
#include "support/ros_encoder.hpp"

namespace pcavr {
namespace {

constexpr char kImageType[] = "sensor_msgs/msg/Image";

std::vector<std::uint8_t> bytes_of(const RosEncoder& encoder) {
  return {encoder.bytes().begin(), encoder.bytes().end()};
}

/// An image of tags side by side, as a camera publishes it.
std::vector<std::uint8_t> image_of(const std::vector<MarkerId>& ids) {
  const CameraModel camera{.width = 320, .height = 240, .fx = 300, .fy = 300, .cx = 160, .cy = 120};
  std::vector<test::RenderedTag> tags;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const double x = 0.12 * (static_cast<double>(i) - 0.5 * static_cast<double>(ids.size() - 1));
    tags.push_back({ids[i], 0.08, test::facing({x, 0.0, 0.5}, 0.1, 0.0, 0.0)});
  }
  const GrayImage image = test::render_tags(tags, camera);
  const std::string pixels(image.pixels().begin(), image.pixels().end());
  return bytes_of(RosEncoder(RosEncoder::Format::cdr)
                      .image(Stamp::from_seconds(1.0), "camera", 320, 240, "mono8", pixels));
}

/// The watch's word on a message; none where the message says nothing of tags.
std::optional<TagWatch::Sight> sight_of(TagWatch& watch, std::size_t topic,
                                        const std::vector<std::uint8_t>& message) {
  using namespace std::chrono_literals;
  watch.offer(topic, kImageType, message);
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (std::chrono::steady_clock::now() < end) {
    if (auto sight = watch.take()) return sight;
    if (watch.is_idle()) return watch.take();
    std::this_thread::sleep_for(1ms);
  }
  ADD_FAILURE() << "no answer";
  return std::nullopt;
}

TEST(TagWatch, CountsTheDeclaredTagsOfAnImage) {
  const auto watch = TagWatch::create({{"tag36h11", 3}, {"tag36h11", 5}});
  ASSERT_TRUE(watch) << watch.error().to_string();
  const auto both = sight_of(**watch, 7, image_of({{"tag36h11", 3}, {"tag36h11", 5}}));
  ASSERT_TRUE(both);
  EXPECT_EQ(both->topic, 7U);
  EXPECT_EQ(both->tags, 2U);
  const auto one = sight_of(**watch, 8, image_of({{"tag36h11", 3}, {"tag36h11", 9}}));
  ASSERT_TRUE(one);
  EXPECT_EQ(one->topic, 8U);
  EXPECT_EQ(one->tags, 1U);  // 9 is not declared
  const auto none = sight_of(**watch, 8, image_of({}));
  ASSERT_TRUE(none);
  EXPECT_EQ(none->tags, 0U);
  EXPECT_FALSE((*watch)->take());  // once
}

TEST(TagWatch, SaysNothingOfDepthAndOfDamagedImages) {
  const auto watch = TagWatch::create({{"tag36h11", 3}});
  ASSERT_TRUE(watch);
  const std::string depth(4 * 3 * 2, '\1');
  EXPECT_FALSE(sight_of(
      **watch, 0,
      bytes_of(RosEncoder(RosEncoder::Format::cdr).image(Stamp{}, "depth", 4, 3, "16UC1", depth))));
  // A size of gigabytes in a few bytes.
  EXPECT_FALSE(sight_of(**watch, 0,
                        bytes_of(RosEncoder(RosEncoder::Format::cdr)
                                     .image(Stamp{}, "camera", 60000, 60000, "mono8", depth))));
  std::vector<std::uint8_t> cut = image_of({{"tag36h11", 3}});
  cut.resize(100);
  EXPECT_FALSE(sight_of(**watch, 0, cut));
  EXPECT_TRUE((*watch)->is_idle());
  const auto sight = sight_of(**watch, 0, image_of({{"tag36h11", 3}}));  // goes on
  ASSERT_TRUE(sight);
  EXPECT_EQ(sight->tags, 1U);
}

TEST(TagWatch, KnowsNoFamilyThatThereIsNot) { EXPECT_FALSE(TagWatch::create({{"tag99h99", 0}})); }

}  // namespace
}  // namespace pcavr
