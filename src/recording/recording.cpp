// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/recording.hpp"

#include <utility>

#include "pcavr/core/input_file.hpp"
#include "pcavr/core/input_ranges.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/recording/line_counts.hpp"

#include "recording/image_lists.hpp"
#include "recording/manifest_parser.hpp"
#include "recording/time_series.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Notes what was left out of a file, and that its last line may have been cut.
void note(const RowReport& report, const char* name, Recording& recording) {
  for (const auto& [reason, count] : report.left_out) {
    recording.left_out.push_back({name, reason, count});
  }
  if (report.short_last_line) {
    recording.warnings.push_back((recording.folder / name).string() + ':' +
                                 std::to_string(*report.short_last_line) +
                                 ": the last line has no end and is shorter than those before it; "
                                 "was the file cut?");
  }
}

/// A file of the recording through its parser; an empty content where there is no such file.
template <typename Content>
Expected<Content> read_if_there(Recording& recording, const char* name, bool skip_bad,
                                Expected<Series<Content>> (*parse)(const SeriesText&)) {
  const fs::path file = recording.folder / name;
  const Expected<bool> is_there = is_present(file);
  if (!is_there) return is_there.error();
  if (!*is_there) return Content{};
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<Content>> series = parse({file.string(), *text, skip_bad});
  if (!series) return series.error();
  note(series->report, name, recording);
  return std::move(series->content);
}

Expected<void> read_frames(Recording& recording, const ReadOptions& options) {
  const Expected<bool> has_color = is_present(recording.folder / "rgb.txt");
  if (!has_color) return has_color.error();
  const Expected<bool> has_depth = is_present(recording.folder / "depth.txt");
  if (!has_depth) return has_depth.error();
  if (!*has_color && !*has_depth) return {};
  if (*has_color != *has_depth) {
    return Error{.message = std::string(*has_color ? "depth.txt" : "rgb.txt") + " is missing",
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
  note(images->color_report, "rgb.txt", recording);
  note(images->depth_report, "depth.txt", recording);
  return {};
}

Expected<Manifest> read_manifest(const fs::path& folder) {
  const fs::path file = folder / "recording.yaml";
  const Expected<bool> is_there = is_present(file);
  if (!is_there) return is_there.error();
  if (!*is_there) {
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

/// A series' stamps, first and last, and the file that they are from.
struct Ends {
  const char* file;
  Stamp first;
  Stamp last;
};

template <typename Samples>
void add_ends(const char* file, const Samples& samples, std::vector<Ends>& ends) {
  if (!samples.empty()) ends.push_back({file, samples.front().stamp, samples.back().stamp});
}

/// Ten hours in one series are a slip of a stamp's unit: what is made of it would never end.
Expected<void> check_spans(const Recording& recording) {
  std::vector<Ends> all;
  add_ends("groundtruth.txt", recording.groundtruth.poses(), all);
  add_ends("tool.csv", recording.tool.poses(), all);
  add_ends("wrench.csv", recording.wrench, all);
  add_ends("joints.csv", recording.joints, all);
  if (!recording.frames.empty()) {
    all.push_back(
        {"depth.txt", recording.frames.front().depth_stamp, recording.frames.back().depth_stamp});
  }
  for (const Ends& ends : all) {
    std::optional<Error> error = check_range(ranges::kSpan, to_seconds(ends.last - ends.first));
    if (!error) continue;
    error->file = (recording.folder / ends.file).string();
    error->message = "goes from " + format_stamp(ends.first) + " to " + format_stamp(ends.last) +
                     " s, more than ten hours";
    error->hint = "write stamps in seconds on one clock, or split the recording";
    return *std::move(error);
  }
  return {};
}

/// What pcavr wrote itself has to be whole.
Expected<void> check_whole(Recording& recording, bool skip_bad) {
  const Expected<void> whole = check_line_counts(recording.folder / kWrittenFile);
  if (whole || !skip_bad) return whole;
  recording.warnings.push_back(whole.error().to_string());
  return {};
}

}  // namespace

std::size_t Recording::skipped_rows() const {
  std::size_t sum = 0;
  for (const LeftOut& entry : left_out) sum += entry.count;
  return sum;
}

Expected<Recording> read_recording(const fs::path& folder, const ReadOptions& options) {
  const Expected<bool> is_there = is_present(folder);
  if (!is_there) return is_there.error();
  std::error_code code;
  if (!fs::is_directory(folder, code)) {
    return Error{.message = *is_there ? "is not a folder" : "is not there",
                 .file = folder.string(),
                 .hint = "give the folder that holds recording.yaml"};
  }
  Recording recording;
  recording.folder = folder;
  if (auto kept = keep(read_manifest(folder), recording.manifest); !kept) return kept.error();
  if (auto read = read_frames(recording, options); !read) return read.error();
  if (auto read = read_series(recording, options.skip_bad); !read) return read.error();
  if (auto sound = check_spans(recording); !sound) return sound.error();
  if (auto whole = check_whole(recording, options.skip_bad); !whole) return whole.error();
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
