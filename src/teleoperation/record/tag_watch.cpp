// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tag_watch.hpp"

#include <algorithm>
#include <utility>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {
namespace {

constexpr std::int64_t kMaxPixels = 100'000'000;  // a few bytes may state a size of gigabytes

}  // namespace

Expected<std::unique_ptr<TagWatch>> TagWatch::create(const std::vector<MarkerId>& declared) {
  std::set<std::string> families;
  for (const MarkerId& id : declared) families.insert(id.family);
  Expected<TagDetector> detector = TagDetector::create({families.begin(), families.end()});
  if (!detector) return detector.error();
  return std::make_unique<TagWatch>(std::set<MarkerId>(declared.begin(), declared.end()),
                                    std::move(*detector));
}

TagWatch::TagWatch(std::set<MarkerId> declared, TagDetector detector)
    : declared_(std::move(declared)), detector_(std::move(detector)), thread_([this] { run(); }) {}

TagWatch::~TagWatch() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  arrived_.notify_all();
  thread_.join();
}

bool TagWatch::is_idle() const {
  const std::lock_guard lock(mutex_);
  return !is_busy_ && !image_ && !sight_;
}

void TagWatch::offer(std::size_t topic, const std::string& type,
                     std::span<const std::uint8_t> message) {
  if (!is_idle()) return;
  {
    const std::lock_guard lock(mutex_);
    image_ = Image{topic, type, {message.begin(), message.end()}};
  }
  arrived_.notify_all();
}

std::optional<TagWatch::Sight> TagWatch::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(sight_, std::nullopt);
}

void TagWatch::run() {
  for (;;) {
    Image image;
    {
      std::unique_lock lock(mutex_);
      arrived_.wait(lock, [this] { return is_stopped_ || image_; });
      if (is_stopped_) return;
      image = *std::exchange(image_, std::nullopt);
      is_busy_ = true;
    }
    // An image that a library refuses must not end the recording.
    const Expected<std::optional<std::size_t>> tags = caught([&] { return count(image); });
    const std::lock_guard lock(mutex_);
    if (tags && *tags) sight_ = Sight{image.topic, **tags};
    is_busy_ = false;
  }
}

std::optional<std::size_t> TagWatch::count(const Image& image) {
  const BagTopic topic{
      .name = {}, .type = image.type, .encoding = "cdr", .schema_encoding = {}, .schema = {}};
  const Expected<RosMessage> message = decode_ros_message(topic, image.message);
  if (!message) return std::nullopt;
  const auto [width, height] = image_size(*message);
  if (width <= 0 || height <= 0 || std::int64_t{width} * height > kMaxPixels) return std::nullopt;
  const Expected<ColorImage> color = decode_color(*message, width, height);
  if (!color) return std::nullopt;  // depth, or damaged: it says nothing of tags
  const std::vector<TagDetection> detections = detector_.detect(to_gray(*color));
  return static_cast<std::size_t>(
      std::count_if(detections.begin(), detections.end(),
                    [&](const TagDetection& tag) { return declared_.contains(tag.id); }));
}

}  // namespace pcavr
