// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/import.hpp"

#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"

#include "recordings/recording/image_lists.hpp"
#include "recordings/recording/import_depth_scale.hpp"
#include "recordings/recording/import_formats.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

Expected<ImportFormat> detect_format(const fs::path& source) {
  std::error_code code;
  if (!fs::is_directory(source, code)) {
    return Error{.message = "is not a folder",
                 .file = source.string(),
                 .hint = "give the folder that contains the images"};
  }
  if (fs::exists(source / "recording.yaml", code)) {
    return Error{.message = "is already a recording",
                 .file = source.string(),
                 .hint = "use it without importing"};
  }
  if (fs::exists(source / "rgb.txt", code) && fs::exists(source / "depth.txt", code)) {
    return ImportFormat::tum_rgbd;
  }
  if (has_seven_scenes_frames(source)) return ImportFormat::seven_scenes;
  return Error{.message = "is neither a TUM RGB-D folder nor a 7-Scenes folder",
               .file = source.string(),
               .hint =
                   "the first has rgb.txt and depth.txt, the second files named "
                   "frame-000000.color.png"};
}

Expected<ImportReport> import_tum(const fs::path& source, const fs::path& target,
                                  const ImportOptions& options, const Observer& observer) {
  if (!options.camera) {
    return Error{.message = "contains no camera calibration; TUM RGB-D folders never do",
                 .file = source.string(),
                 .hint = "give --camera with a calibration file"};
  }
  const Expected<PairedImages> images = read_image_lists(source, {});
  if (!images) return images.error();
  ImportReport report{.format = ImportFormat::tum_rgbd};
  report.left_out = images->unpaired_color + images->unpaired_depth;
  std::vector<fs::path> depth_files;
  for (const FrameFiles& frame : images->frames) depth_files.push_back(source / frame.depth_path);
  report.depth_scale = choose_depth_scale(depth_files, *options.camera, report.format, options);
  RecordingWriter writer(target,
                         {.camera = options.camera, .depth_scale = report.depth_scale.used});
  const std::size_t count = images->frames.size();
  for (std::size_t i = options.first; i < count; i += options.stride) {
    const FrameFiles& frame = images->frames[i];
    const Expected<void> added = writer.add_frame_files(
        frame.color_stamp, source / frame.color_path, frame.depth_stamp, source / frame.depth_path);
    if (!added) return added.error();
    ++report.frames;
    observer.on_progress("import", i + 1, count);
  }
  std::error_code code;
  if (const fs::path file = source / "groundtruth.txt"; fs::exists(file, code)) {
    const Expected<Trajectory> T_base_camera = read_trajectory(file);
    if (!T_base_camera) return T_base_camera.error();
    if (auto written = writer.write_groundtruth(*T_base_camera); !written) return written.error();
    report.poses = T_base_camera->size();
  }
  if (auto finished = writer.finish(); !finished) return finished.error();
  return report;
}

}  // namespace

double usual_depth_scale(ImportFormat format) {
  return format == ImportFormat::tum_rgbd ? 5000.0 : 1000.0;
}

Expected<ImportReport> import_recording(const fs::path& source, const fs::path& target,
                                        const ImportOptions& options, const Observer& observer) {
  PCAVR_REQUIRE(options.stride >= 1, options.stride);
  PCAVR_REQUIRE(options.frame_rate >= 0.1 && options.frame_rate <= 1e5, options.frame_rate);
  const Expected<ImportFormat> format =
      options.format ? Expected<ImportFormat>(*options.format) : detect_format(source);
  if (!format) return format.error();
  Expected<ImportReport> report = *format == ImportFormat::tum_rgbd
                                      ? import_tum(source, target, options, observer)
                                      : import_seven_scenes(source, target, options, observer);
  if (report && report->frames == 0) {
    return Error{.message = "no frames are left to import",
                 .file = source.string(),
                 .hint = "choose a smaller --first"};
  }
  return report;
}

}  // namespace pcavr
