// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/calibrate_tags.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {
namespace {

constexpr int kMaxTagNumber = 1'000'000;

/// Columns of a table of corners.
struct CornerColumns {
  std::size_t stamp = 0, id = 0;
  std::optional<std::size_t> family = {};
  std::array<std::size_t, 8> corners = {};
};

std::optional<std::size_t> column_named(const std::vector<std::string>& names, const char* name) {
  const auto found = find_column(names, {name});
  return found ? std::optional(found->column) : std::nullopt;
}

Expected<CornerColumns> corner_columns(const std::vector<std::string>& names) {
  constexpr std::array<const char*, 8> kCorners = {"u0", "v0", "u1", "v1", "u2", "v2", "u3", "v3"};
  CornerColumns columns;
  const auto stamp = column_named(names, "t"), id = column_named(names, "id");
  bool is_complete = stamp && id;
  for (std::size_t i = 0; i < kCorners.size(); ++i) {
    const auto corner = column_named(names, kCorners[i]);
    is_complete = is_complete && corner;
    if (corner) columns.corners[i] = *corner;
  }
  if (!is_complete) {
    return Error{.message = "has no columns of tag corners",
                 .line = 1,
                 .hint = "name them t, id, u0, v0, u1, v1, u2, v2, u3, v3, or give a recording"};
  }
  columns.stamp = *stamp;
  columns.id = *id;
  columns.family = column_named(names, "family");
  return columns;
}

bool is_tag_family(const std::string& name) {
  const std::vector<std::string>& known = tag_families();
  return std::find(known.begin(), known.end(), name) != known.end();
}

struct CornerRow {
  Stamp stamp;
  TagDetection detection;
};

Expected<CornerRow> corner_row(const std::vector<std::string>& fields, const CornerColumns& columns,
                               std::size_t width, const std::string& family) {
  if (fields.size() != width) {
    return Error{.message = fmt::format("has {} columns, the header {}", fields.size(), width),
                 .hint = "--skip-bad leaves such rows out"};
  }
  const Expected<Stamp> stamp = parse_stamp(fields[columns.stamp], TimeUnit::seconds);
  if (!stamp) return stamp.error();
  const std::optional<double> id = parse_number(fields[columns.id]);
  if (!id || *id < 0.0 || *id > kMaxTagNumber || *id != static_cast<int>(*id)) {
    return Error{.message = "'" + fields[columns.id] + "' is no number of a tag",
                 .hint = "--skip-bad leaves such rows out"};
  }
  CornerRow row{*stamp, {.id = {family, static_cast<int>(*id)}, .corners = {}}};
  if (columns.family && is_tag_family(fields[*columns.family])) {
    row.detection.id.family = fields[*columns.family];
  }
  for (std::size_t i = 0; i < 8; ++i) {
    const std::optional<double> number = parse_number(fields[columns.corners[i]]);
    if (!number) {
      return Error{.message = "'" + fields[columns.corners[i]] + "' is not a finite number",
                   .hint = "--skip-bad leaves such rows out"};
    }
    row.detection.corners[i / 2][static_cast<Eigen::Index>(i % 2)] = *number;
  }
  return row;
}

/// The tags of one image; an id that is there twice is left out, as a detector does.
std::vector<TagDetection> without_copies(std::vector<TagDetection> tags) {
  std::map<MarkerId, int> counts;
  for (const TagDetection& tag : tags) ++counts[tag.id];
  std::erase_if(tags, [&](const TagDetection& tag) { return counts[tag.id] > 1; });
  return tags;
}

Expected<void> read_corner_table(const TagWalkInput& input, TagWalk& walk) {
  const std::string file = input.input.string();
  const Expected<std::string> text = read_file(input.input);
  if (!text) return text.error();
  LineReader lines(*text);
  const std::optional<std::string_view> header = lines.next();
  const char separator = separator_of(header.value_or(""));
  const std::vector<std::string> names = split_fields(separator, header.value_or(""));
  const auto at = [&](Error error) {
    error.file = file;
    if (error.line == 0) error.line = lines.line();
    return error;
  };
  const Expected<CornerColumns> columns = corner_columns(names);
  if (!columns) return at(columns.error());
  std::map<Stamp, std::vector<TagDetection>> by_stamp;
  std::size_t skipped = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    const Expected<CornerRow> row =
        corner_row(split_fields(separator, *line), *columns, names.size(), input.family);
    if (!row && !input.skip_bad) return at(row.error());
    skipped += row ? 0 : 1;
    if (row) by_stamp[row->stamp].push_back(row->detection);
  }
  for (auto& [stamp, tags] : by_stamp) {
    walk.stamps.push_back(stamp);
    walk.frames.push_back(without_copies(std::move(tags)));
  }
  if (skipped > 0) walk.notes.push_back(fmt::format("{} rows can't be read: left out", skipped));
  return {};
}

Expected<void> detect_tags(const Recording& recording, const TagWalkInput& input,
                           const Observer& observer, TagWalk& walk) {
  std::set<std::string> families;
  for (const MarkerEntry& marker : walk.known.markers) families.insert(marker.id.family);
  for (const auto& [id, size] : walk.known.unplaced) families.insert(id.family);
  if (families.empty()) families.insert(input.family);
  TagDetectorOptions options;
  if (walk.camera.has_distortion()) options.lens = walk.camera;
  Expected<TagDetector> detector = TagDetector::create({families.begin(), families.end()}, options);
  if (!detector) return detector.error();
  FrameReader reader(recording, {.skip_bad = input.skip_bad});
  std::map<MarkerId, std::size_t> twice;
  while (true) {
    const Expected<std::optional<RgbdFrame>> frame = reader.next();
    if (!frame) return frame.error();
    if (!*frame) break;
    walk.stamps.push_back((*frame)->color_stamp);
    walk.frames.push_back(detector->detect(to_gray((*frame)->color)));
    for (const MarkerId& id : detector->seen_twice()) ++twice[id];
    observer.on_progress("Detecting tags", walk.frames.size(), recording.frames.size());
  }
  for (const auto& [id, count] : twice) {
    walk.notes.push_back(fmt::format("{} is in {} images twice: not used there; cover the copy",
                                     id.to_string(), count));
  }
  return {};
}

Error no_camera(const std::filesystem::path& file) {
  return {.message = "has corners, of which no camera is known",
          .file = file.string(),
          .hint = "give its intrinsics: --camera camera.yaml"};
}

Expected<void> read_layout(const TagWalkInput& input, TagWalk& walk) {
  if (input.layout.empty()) return {};
  Expected<TagFile> known = read_tag_file(input.layout, input.family);
  if (!known) return known.error();
  walk.known = *std::move(known);
  return {};
}

Expected<TagWalk> walk_of_recording(const TagWalkInput& input, const Observer& observer) {
  ReadOptions reading;
  reading.skip_bad = input.skip_bad;
  const Expected<Recording> recording = read_recording(input.input, reading);
  if (!recording) return recording.error();
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  TagWalk walk;
  walk.known = {.format = "the recording's markers", .markers = recording->manifest.markers};
  const Expected<void> layout = read_layout(input, walk);
  if (!layout) return layout.error();
  if (!recording->manifest.camera || recording->frames.empty()) {
    return Error{.message = "has no images",
                 .file = input.input.string(),
                 .hint = "give a recording with images of the tags, or a table of their corners"};
  }
  walk.camera = *recording->manifest.camera;
  const Expected<void> detected = detect_tags(*recording, input, observer, walk);
  if (!detected) return detected.error();
  return walk;
}

}  // namespace

Expected<TagWalk> read_tag_walk(const TagWalkInput& input, const Observer& observer) {
  std::error_code code;
  if (std::filesystem::is_directory(input.input, code)) return walk_of_recording(input, observer);
  TagWalk walk;
  const Expected<void> layout = read_layout(input, walk);
  if (!layout) return layout.error();
  const Expected<void> corners = read_corner_table(input, walk);
  if (!corners) return corners.error();
  if (input.camera.empty()) return no_camera(input.input);
  const Expected<CameraFile> camera = read_camera_file(input.camera);
  if (!camera) return camera.error();
  walk.camera = camera->camera;
  return walk;
}

}  // namespace pcavr
