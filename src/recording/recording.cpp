// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/recording.hpp"

#include <utility>

#include "pcavr/core/output.hpp"

#include "recording/image_lists.hpp"
#include "recording/manifest_parser.hpp"
#include "recording/time_series.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// A file of the recording through its parser; an empty content where there is no such file.
/// Adds the rows left out to `recording`.
template <typename Content>
Expected<Content> read_if_there(Recording& recording, const char* name, bool skip_bad,
                                Expected<Series<Content>> (*parse)(const SeriesText&)) {
  const fs::path file = recording.folder / name;
  std::error_code code;
  if (!fs::exists(file, code)) return Content{};
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<Content>> series = parse({file.string(), *text, skip_bad});
  if (!series) return series.error();
  recording.skipped_rows += series->skipped;
  return std::move(series->content);
}

Expected<void> read_frames(Recording& recording, const ReadOptions& options) {
  std::error_code code;
  const bool has_color = fs::exists(recording.folder / "rgb.txt", code);
  const bool has_depth = fs::exists(recording.folder / "depth.txt", code);
  if (!has_color && !has_depth) return {};
  if (has_color != has_depth) {
    return Error{.message = std::string(has_color ? "depth.txt" : "rgb.txt") + " is missing",
                 .file = recording.folder.string(),
                 .hint = "a recording has both lists, or none where it holds no images"};
  }
  if (!recording.manifest.camera) {
    return Error{.message = "key 'camera' is missing, though there are images",
                 .file = (recording.folder / "recording.yaml").string(),
                 .hint = "add the camera with its intrinsics and depth_scale"};
  }
  Expected<PairedImages> images = read_image_lists(recording.folder, options);
  if (!images) return images.error();
  recording.frames = std::move(images->frames);
  recording.unpaired_color = images->unpaired_color;
  recording.unpaired_depth = images->unpaired_depth;
  recording.skipped_rows += images->skipped_rows;
  return {};
}

Expected<Manifest> read_manifest(const fs::path& folder) {
  const fs::path file = folder / "recording.yaml";
  std::error_code code;
  if (!fs::exists(file, code)) {
    return Error{.message = "is not a recording: it holds no recording.yaml",
                 .file = folder.string(),
                 .hint = "check the path; 'pcavr import' turns other folders into recordings"};
  }
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_manifest(*text, file.string(), folder);
}

/// Moves a value into its place, or hands its error back.
template <typename Content>
Expected<void> keep(Expected<Content> read, Content& place) {
  if (!read) return read.error();
  place = *std::move(read);
  return {};
}

Expected<void> read_series(Recording& recording, bool skip_bad) {
  if (auto kept = keep(read_if_there(recording, "groundtruth.txt", skip_bad, parse_trajectory),
                       recording.groundtruth);
      !kept) {
    return kept;
  }
  if (auto kept = keep(read_if_there(recording, "tool.csv", skip_bad, parse_tool), recording.tool);
      !kept) {
    return kept;
  }
  if (auto kept =
          keep(read_if_there(recording, "wrench.csv", skip_bad, parse_wrench), recording.wrench);
      !kept) {
    return kept;
  }
  return keep(read_if_there(recording, "joints.csv", skip_bad, parse_joints), recording.joints);
}

}  // namespace

Expected<Recording> read_recording(const fs::path& folder, const ReadOptions& options) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) {
    return Error{.message = "is not a folder",
                 .file = folder.string(),
                 .hint = "give the folder that holds recording.yaml"};
  }
  Recording recording;
  recording.folder = folder;
  if (auto kept = keep(read_manifest(folder), recording.manifest); !kept) return kept.error();
  if (auto read = read_frames(recording, options); !read) return read.error();
  if (auto read = read_series(recording, options.skip_bad); !read) return read.error();
  return recording;
}

Expected<Trajectory> read_trajectory(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<Trajectory>> series = parse_trajectory({file.string(), *text});
  if (!series) return series.error();
  return std::move(series->content);
}

}  // namespace pcavr
