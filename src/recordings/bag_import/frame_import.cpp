// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/frame_import.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/pairing.hpp"

#include "recordings/bag_import/decoded_header.hpp"

namespace pcavr {
namespace {

constexpr Duration kMaxFramePairGap = std::chrono::milliseconds(20);
constexpr std::size_t kMaxWaiting = 128;

std::vector<Stamp> sorted_stamps(const CollectedTopic<std::monostate>& topic) {
  std::vector<Stamp> stamps;
  for (const auto& row : topic.rows) stamps.push_back(row.stamp);
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

/// Assembles frames from images in any order.
class FrameAssembler {
 public:
  FrameAssembler(const std::vector<FramePlan>& plan, const BagSelection& selection,
                 const CameraModel& camera, double depth_scale, RecordingWriter& writer)
      : plan_(plan),
        has_color_(selection.color != nullptr),
        has_depth_(selection.depth != nullptr),
        camera_(camera),
        depth_scale_(depth_scale),
        writer_(writer) {
    for (std::size_t i = 0; i < plan.size(); ++i) {
      if (has_depth_) by_depth_[plan[i].depth] = i;
      if (has_color_) by_color_[plan[i].color] = i;
    }
  }

  /// The frame an image belongs to; nullopt where it is not needed, or no more.
  std::optional<std::size_t> frame_of(Stamp stamp, bool is_depth) const {
    const auto& frames = is_depth ? by_depth_ : by_color_;
    const auto found = frames.find(stamp);
    if (found == frames.end() || found->second < next_) return std::nullopt;
    const auto waiting = waiting_.find(found->second);
    if (waiting == waiting_.end()) return found->second;
    const Waiting& frame = waiting->second;
    const bool is_there = frame.is_failed || (is_depth ? frame.depth : frame.color).has_value();
    return is_there ? std::nullopt : std::optional(found->second);
  }

  Expected<void> add(std::size_t index, bool is_depth, const RosMessage& message) {
    Expected<ConvertedImage> image =
        is_depth ? convert_depth(message, depth_scale_) : convert_color(message);
    Waiting& frame = waiting_[index];
    if (image) {
      if (const std::string fault = fault_of_size(*image, is_depth); !fault.empty()) {
        image = Error{.message = fault};
      }
    }
    if (!image)
      fail(frame, image.error().message);
    else if (is_depth)
      frame.depth = std::move(image->file);
    else
      frame.color = std::move(image->file);
    return write_ready(waiting_.size() > kMaxWaiting);
  }

  Expected<FrameCounts> finish() {
    while (next_ < plan_.size()) {
      if (const auto done = write_ready(true); !done) return done.error();
    }
    return counts_;
  }

 private:
  struct Waiting {
    std::optional<EncodedImage> depth, color;
    bool is_failed = false;
  };

  std::string fault_of_size(const ConvertedImage& image, bool is_depth) const {
    const bool is_same = image.width == camera_.width && image.height == camera_.height;
    // Depth may be coarser by one factor.
    const bool is_coarser = image.width > 0 && image.height > 0 &&
                            camera_.width % image.width == 0 &&
                            camera_.height % image.height == 0 &&
                            camera_.width / image.width == camera_.height / image.height;
    if (is_same || (is_depth && is_coarser)) return {};
    return std::string(is_depth ? "depth" : "colour") + " image has " +
           std::to_string(image.width) + " x " + std::to_string(image.height) +
           " pixels, but the camera is for " + std::to_string(camera_.width) + " x " +
           std::to_string(camera_.height);
  }

  void fail(Waiting& frame, const std::string& reason) {
    frame.is_failed = true;
    frame.depth.reset();
    frame.color.reset();
    if (counts_.left_out_reason.empty()) counts_.left_out_reason = reason;
  }

  /// Writes frames in order; `may_skip` gives up waiting for the first.
  Expected<void> write_ready(bool may_skip) {
    for (; next_ < plan_.size(); ++next_) {
      const auto found = waiting_.find(next_);
      const bool is_whole = found != waiting_.end() && (found->second.depth || !has_depth_) &&
                            (found->second.color || !has_color_);
      const bool is_failed = found != waiting_.end() && found->second.is_failed;
      if (!is_whole && !is_failed && !std::exchange(may_skip, false)) return {};
      if (is_whole) {
        if (const auto written = write(plan_[next_], found->second); !written) return written;
        ++counts_.frames;
      } else {
        ++counts_.left_out;
        if (counts_.left_out_reason.empty())
          counts_.left_out_reason = "an image of it was not found";
      }
      if (found != waiting_.end()) waiting_.erase(found);
    }
    return {};
  }

  Expected<void> write(const FramePlan& frame, Waiting& images) {
    if (!has_depth_) return writer_.add_encoded_color(frame.color, *images.color);
    if (!images.color && !grey_) {
      const Expected<std::string> jpeg =
          encode_color(ColorImage(camera_.width, camera_.height, Rgb8{128, 128, 128}));
      if (!jpeg) return jpeg.error();
      grey_ = EncodedImage{*jpeg, ".jpg"};
    }
    return writer_.add_encoded_frame(frame.color, images.color ? *images.color : *grey_,
                                     frame.depth, *images.depth);
  }

  const std::vector<FramePlan>& plan_;
  bool has_color_;
  bool has_depth_;
  const CameraModel& camera_;
  double depth_scale_;
  RecordingWriter& writer_;
  std::map<Stamp, std::size_t> by_depth_, by_color_;
  std::map<std::size_t, Waiting> waiting_;
  std::size_t next_ = 0;
  std::optional<EncodedImage> grey_;
  FrameCounts counts_;
};

bool is_topic(const BagTopic& topic, const SurveyedTopic* surveyed) {
  return surveyed != nullptr && surveyed->topic.name == topic.name &&
         surveyed->topic.type == topic.type && surveyed->topic.encoding == topic.encoding;
}

}  // namespace

std::vector<FramePlan> plan_frames(const BagStreams& streams, const BagImportOptions& options) {
  const std::vector<Stamp> depth = sorted_stamps(streams.depth);
  const std::vector<Stamp> color = sorted_stamps(streams.color);
  std::vector<FramePlan> all;
  if (streams.color.topic == nullptr) {
    for (const Stamp stamp : depth) all.push_back({stamp, stamp});
  } else if (streams.depth.topic == nullptr) {
    for (const Stamp stamp : color) all.push_back({stamp, stamp});
  } else {
    for (const auto& [c, d] : pair_by_time(color, depth, kMaxFramePairGap)) {
      all.push_back({depth[d], color[c]});
    }
  }
  std::vector<FramePlan> plan;
  for (std::size_t i = options.first; i < all.size(); i += options.stride) plan.push_back(all[i]);
  return plan;
}

Expected<FrameCounts> import_frames(const std::filesystem::path& bag, const BagSelection& selection,
                                    const StampRule& stamps, const std::vector<FramePlan>& plan,
                                    const CameraModel& camera, double depth_scale,
                                    RecordingWriter& writer, const Observer& observer) {
  Expected<std::unique_ptr<BagReader>> reader = open_bag_or_csv(bag);
  if (!reader) return reader.error();
  FrameAssembler assembler(plan, selection, camera, depth_scale, writer);
  for (std::size_t done = 0;;) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) return message.error();
    if (!*message) return assembler.finish();
    const BagTopic& topic = (*reader)->topics()[(*message)->topic];
    const bool is_depth = is_topic(topic, selection.depth);
    if (!is_depth && !is_topic(topic, selection.color)) continue;
    const Expected<RosMessage> decoded = decode_ros_message(topic, (*message)->payload);
    if (!decoded) continue;  // was counted when the stamps were collected
    const Stamp stamp = stamps.stamp_of(is_depth ? *selection.depth : *selection.color,
                                        *headers_of(*decoded).front(), (*message)->log_time);
    const std::optional<std::size_t> frame = assembler.frame_of(stamp, is_depth);
    if (!frame) continue;
    if (const auto added = assembler.add(*frame, is_depth, *decoded); !added) return added.error();
    if (is_topic(topic, selection.images())) observer.on_progress("images", ++done, plan.size());
  }
}

}  // namespace pcavr
