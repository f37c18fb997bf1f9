// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/import_checks.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"

namespace pcavr {
namespace {

std::string fixed_text(double value, int decimals) {
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

Expected<void> check_span(const std::filesystem::path& bag, const std::string& place, Stamp first,
                          Stamp last) {
  std::optional<Error> error = check_range(ranges::kSpan, to_seconds(last - first));
  if (!error) return {};
  error->message =
      "goes from " + format_stamp(first) + " to " + format_stamp(last) + " s, more than ten hours";
  error->file = bag.string();
  error->place = place;
  error->hint = "give --stamps receive where the senders' stamps are wrong, or split the bag";
  return *std::move(error);
}

template <typename Value>
Expected<void> check_topic(const std::filesystem::path& bag, const CollectedTopic<Value>& topic) {
  if (topic.topic == nullptr || topic.rows.empty()) return {};
  const auto [first, last] =
      std::minmax_element(topic.rows.begin(), topic.rows.end(),
                          [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return check_span(bag, topic.topic->topic.name, first->stamp, last->stamp);
}

/// Empty where the depth's own camera info is the colour's, or one is not known.
std::string other_cameras_text(const BagSelection& selection, const BagStreams& streams) {
  if (!streams.depth_info || !streams.camera_info) return {};
  const auto size = [](const SurveyedTopic& t) { return ImageSize{t.width, t.height}; };
  const auto depth = camera_of(*streams.depth_info, false, size(*selection.depth));
  const auto color = camera_of(*streams.camera_info, false, size(*selection.color));
  if (!depth || !color) return {};
  constexpr double kRounding = 0.01;  // of focal length and width: two cameras differ by more
  const double scale = double(color->width) / depth->width;
  const auto differs = [&](double d, double c, double whole) {
    return std::abs(scale * d - c) > kRounding * whole;
  };
  const bool is_same =
      !differs(depth->fx, color->fx, color->fx) && !differs(depth->fy, color->fy, color->fy) &&
      !differs(depth->cx, color->cx, color->width) && !differs(depth->cy, color->cy, color->width);
  if (is_same) return {};
  const auto text = [](const SurveyedTopic& info, const CameraModel& camera) {
    return info.topic.name + " (" + std::to_string(camera.width) + " x " +
           std::to_string(camera.height) + " pixels, fx " + fixed_text(camera.fx, 1) + ", cx " +
           fixed_text(camera.cx, 1) + ")";
  };
  return "depth and colour are both in frame '" + joined(selection.depth->frames) +
         "', but of different cameras: " + text(*selection.depth_info, *depth) + " and " +
         text(*selection.camera_info, *color);
}

/// The name is one that manifests allow, because files are named after it.
Expected<void> check_object_name(const std::string& name) {
  const bool is_plain = !name.empty() && name.front() != '.' &&
                        std::all_of(name.begin(), name.end(), [](unsigned char c) {
                          return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
                        });
  if (is_plain) return {};
  return Error{.message = "'" + name + "' can't be an object's name",
               .place = "--object",
               .hint = "use letters, digits, '_', '-' and '.'"};
}

}  // namespace

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Expected<void> check_spans(const std::filesystem::path& bag, const BagStreams& streams) {
  for (const auto& [topic, poses] : streams.poses) {
    if (const auto checked = check_topic(bag, poses); !checked) return checked;
  }
  if (const auto checked = check_topic(bag, streams.wrench); !checked) return checked;
  if (const auto checked = check_topic(bag, streams.joints); !checked) return checked;
  if (const auto checked = check_topic(bag, streams.depth); !checked) return checked;
  return check_topic(bag, streams.color);
}

Expected<void> check_span(const std::filesystem::path& bag, const std::string& frame,
                          const Trajectory& poses) {
  if (poses.empty()) return {};
  return check_span(bag, "TF of '" + frame + "'", poses.poses().front().stamp,
                    poses.poses().back().stamp);
}

std::string replacement_text(const std::vector<TransformTree::StaticValue>& values, Stamp begin) {
  const TransformTree::StaticValue& before = values[0];
  const TransformTree::StaticValue& after = values[1];
  const double distance = translation_distance(before.T_parent_child, after.T_parent_child);
  const double angle = rotation_distance(before.T_parent_child, after.T_parent_child);
  std::string text = "has a static transform that is replaced ";
  if (values.size() > 2) text += std::to_string(values.size() - 1) + " times, first ";
  text += fixed_text(to_seconds(after.since - begin), 3) + " s after the bag's start, ";
  text += before.parent == after.parent
              ? "by " + fixed_text(1e3 * distance, 1) + " mm and " +
                    fixed_text(angle * 180.0 / std::numbers::pi, 2) + " deg"
              : "from parent '" + before.parent + "' to '" + after.parent + "'";
  return text + "; each holds until the next";
}

Expected<void> declare_objects(const BagSelection& selection, Manifest& manifest) {
  for (const auto& object : selection.objects) {
    const std::string& name = object.first;
    if (const auto checked = check_object_name(name); !checked) return checked;
    const bool is_declared =
        std::ranges::any_of(manifest.objects, [&](const auto& one) { return one.name == name; });
    if (!is_declared) manifest.objects.push_back({.name = name, .mesh = {}});
  }
  return {};
}

Expected<void> check_placed_objects(const std::filesystem::path& bag, const BagSelection& selection,
                                    const std::map<std::string, Pose>& T_tracked_object) {
  for (const auto& place : T_tracked_object) {
    const std::string& name = place.first;
    const bool is_tracked =
        std::ranges::any_of(selection.objects, [&](const auto& one) { return one.first == name; });
    if (is_tracked) continue;
    return Error{.message = "'" + name + "' is no tracked object",
                 .file = bag.string(),
                 .place = "--T-tracked-object",
                 .hint = "give --object " + name + "=TOPIC"};
  }
  return {};
}

std::vector<std::string> color_doubts(const BagSelection& selection, const BagStreams& streams) {
  if (selection.color == nullptr) {
    const std::string images = joined(selection.unread_images);
    return {"no colour topic is taken" + (images.empty() ? "" : ": " + images) +
            "; frames are grey, in which no tags are found"};
  }
  std::vector<std::string> doubts;
  const SurveyedTopic& color = *selection.color;
  if (color.image_format == "8UC3" || color.image_format == "8UC4") {
    doubts.push_back(color.topic.name + " is " + color.image_format +
                     ", which does not state the order of its channels: blue, green, red is taken");
  }
  if (selection.depth == nullptr) return doubts;
  const std::string hint = "; record depth that is registered to colour";
  if (color.frames != selection.depth->frames) {
    doubts.push_back("depth and colour are in frames '" + joined(selection.depth->frames) +
                     "' and '" + joined(color.frames) + "'" + hint);
  } else if (const std::string cameras = other_cameras_text(selection, streams); !cameras.empty()) {
    doubts.push_back(cameras + hint);
  }
  return doubts;
}

}  // namespace pcavr
