// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/recording.hpp"

#include <utility>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/held_samples.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"
#include "pcavr/recordings/recording/stamp_blocks.hpp"
#include "pcavr/recordings/recording/stamp_units.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "recordings/recording/image_lists.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Adds a file's skipped rows to the recording, and a warning if its last line may be truncated.
void add_report(const RowReport& report, const char* name, Recording& recording) {
  for (const auto& [reason, count] : report.left_out) {
    recording.left_out.push_back({name, reason, count});
  }
  if (report.short_last_line) {
    recording.warnings.push_back((recording.folder / name).string() + ':' +
                                 std::to_string(*report.short_last_line) +
                                 ": the last line has no line end and is shorter than the previous "
                                 "lines; the file may be truncated");
  }
}

/// Reads and parses a file of the recording; empty content where the file does not exist.
template <typename Content>
Expected<Content> read_if_present(Recording& recording, const char* name, bool skip_bad,
                                  Expected<Series<Content>> (*parse)(const SeriesText&)) {
  const fs::path file = recording.folder / name;
  const Expected<bool> exists = is_present(file);
  if (!exists) return exists.error();
  if (!*exists) return Content{};
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<Content>> series = parse({file.string(), *text, skip_bad});
  if (!series) return series.error();
  add_report(series->report, name, recording);
  return std::move(series->content);
}

Expected<void> read_frames(Recording& recording, const ReadOptions& options) {
  const Expected<bool> has_color = is_present(recording.folder / "rgb.txt");
  if (!has_color) return has_color.error();
  const Expected<bool> has_depth = is_present(recording.folder / "depth.txt");
  if (!has_depth) return has_depth.error();
  if (!*has_color && !*has_depth) return {};
  if (!*has_color) {
    return Error{.message = "rgb.txt is missing",
                 .file = recording.folder.string(),
                 .hint = "a recording with depth images has colour images, too"};
  }
  if (!recording.manifest.camera) {
    return Error{.message = "key 'camera' is missing, but there are images",
                 .file = (recording.folder / "recording.yaml").string(),
                 .hint = "add the camera with its intrinsics and depth_scale"};
  }
  recording.has_depth = *has_depth;
  Expected<PairedImages> images = *has_depth ? read_image_lists(recording.folder, options)
                                             : read_color_list(recording.folder, options);
  if (!images) return images.error();
  recording.frames = std::move(images->frames);
  recording.unpaired_color = images->unpaired_color;
  recording.unpaired_depth = images->unpaired_depth;
  add_report(images->color_report, "rgb.txt", recording);
  add_report(images->depth_report, "depth.txt", recording);
  return {};
}

Expected<Manifest> read_manifest(const fs::path& folder) {
  const fs::path file = folder / "recording.yaml";
  const Expected<bool> exists = is_present(file);
  if (!exists) return exists.error();
  if (!*exists) {
    return Error{.message = "is not a recording: it contains no recording.yaml",
                 .file = folder.string(),
                 .hint = "check the path; 'pcavr import' converts other datasets"};
  }
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_manifest(*text, file.string(), folder);
}

/// Moves a value to `place`, or returns the error.
template <typename Content>
Expected<void> store(Expected<Content> read, Content& place) {
  if (!read) return read.error();
  place = *std::move(read);
  return {};
}

Expected<void> read_series(Recording& recording, bool skip_bad) {
  if (auto stored = store(read_if_present(recording, "groundtruth.txt", skip_bad, parse_trajectory),
                          recording.groundtruth);
      !stored) {
    return stored;
  }
  if (auto stored =
          store(read_if_present(recording, "tool.csv", skip_bad, parse_tool), recording.tool);
      !stored) {
    return stored;
  }
  if (auto stored =
          store(read_if_present(recording, "wrench.csv", skip_bad, parse_wrench), recording.wrench);
      !stored) {
    return stored;
  }
  return store(read_if_present(recording, "joints.csv", skip_bad, parse_joints), recording.joints);
}

/// First and last stamp of a series, and its file.
struct SeriesSpan {
  const char* file;
  Stamp first;
  Stamp last;
  std::size_t rows = 0;
};

template <typename Samples>
void add_span(const char* file, const Samples& samples, std::vector<SeriesSpan>& spans) {
  if (!samples.empty())
    spans.push_back({file, samples.front().stamp, samples.back().stamp, samples.size()});
}

/// Rejects series of more than ten hours: a stamp has the wrong unit, and computations over such a
/// span would take unlimited time and memory.
Expected<void> check_spans(const Recording& recording) {
  std::vector<SeriesSpan> spans;
  add_span("groundtruth.txt", recording.groundtruth.poses(), spans);
  add_span("tool.csv", recording.tool.poses(), spans);
  add_span("wrench.csv", recording.wrench, spans);
  add_span("joints.csv", recording.joints, spans);
  if (!recording.frames.empty()) {
    spans.push_back({recording.has_depth ? "depth.txt" : "rgb.txt",
                     recording.frames.front().depth_stamp, recording.frames.back().depth_stamp,
                     recording.frames.size()});
  }
  for (const SeriesSpan& span : spans) {
    std::optional<Error> error = check_range(ranges::kSpan, to_seconds(span.last - span.first));
    if (!error) continue;
    error->file = (recording.folder / span.file).string();
    error->message = "goes from " + format_stamp(span.first) + " to " + format_stamp(span.last) +
                     " s, more than ten hours";
    error->hint = "write stamps in seconds on one clock, or split the recording";
    const double interval = to_seconds(span.last - span.first) / static_cast<double>(span.rows);
    if (const auto unit = unit_of_interval(interval)) {
      error->hint = "the stamps are probably in " + *unit + ": " + error->hint;
    }
    return *std::move(error);
  }
  return {};
}

/// Leaves out what a controller republished: the source's own samples stay.
template <typename Samples>
void leave_out_repeats(const char* file, Samples& samples, Recording& recording) {
  if (auto note = leave_out_held(file, samples)) recording.notes.push_back(*std::move(note));
}

template <typename Samples>
void warn_of_blocks(const char* file, const Samples& samples, Recording& recording) {
  std::vector<double> t;
  for (const auto& sample : samples) t.push_back(to_seconds(sample.stamp - samples.front().stamp));
  const std::string path = (recording.folder / file).string();
  if (auto warning = warn_of_stamp_blocks(path, t)) recording.warnings.push_back(*warning);
}

void warn_of_stamp_units(Recording& recording) {
  for (const std::string& warning : doubtful_stamp_units(paces_of(recording))) {
    recording.warnings.push_back((recording.folder / warning).string());
  }
}

/// Checks that files that pcavr wrote are complete (line_counts.hpp).
Expected<void> check_intact(Recording& recording, bool skip_bad) {
  const Expected<void> intact = check_line_counts(recording.folder / kWrittenFile);
  if (intact || !skip_bad) return intact;
  recording.warnings.push_back(intact.error().to_string());
  return {};
}

}  // namespace

std::size_t Recording::skipped_rows() const {
  std::size_t sum = 0;
  for (const SkippedRows& entry : left_out) sum += entry.count;
  return sum;
}

Expected<Recording> read_recording(const fs::path& folder, const ReadOptions& options) {
  const Expected<bool> exists = is_present(folder);
  if (!exists) return exists.error();
  std::error_code code;
  if (!fs::is_directory(folder, code)) {
    return Error{.message = *exists ? "is not a folder" : "does not exist",
                 .file = folder.string(),
                 .hint = "give the folder that contains recording.yaml"};
  }
  Recording recording;
  recording.folder = folder;
  if (auto stored = store(read_manifest(folder), recording.manifest); !stored)
    return stored.error();
  if (auto read = read_frames(recording, options); !read) return read.error();
  if (auto read = read_series(recording, options.skip_bad); !read) return read.error();
  if (auto valid = check_spans(recording); !valid) return valid.error();
  if (auto intact = check_intact(recording, options.skip_bad); !intact) return intact.error();
  warn_of_stamp_units(recording);
  leave_out_repeats("groundtruth.txt", recording.groundtruth, recording);
  leave_out_repeats("tool.csv", recording.tool, recording);
  leave_out_repeats("wrench.csv", recording.wrench, recording);
  warn_of_blocks("tool.csv", recording.tool.poses(), recording);
  warn_of_blocks("wrench.csv", recording.wrench, recording);
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
