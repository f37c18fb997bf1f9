// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/png_codec.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/recording/camera_keys.hpp"
#include "recordings/recording/import_depth_scale.hpp"
#include "recordings/recording/import_formats.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPrefix = "frame-";

/// The value of 7-Scenes depth images where nothing was measured.
constexpr std::uint16_t kInvalidDepth = 65535;

/// Keeps stamps in range at any frame rate; the names have six digits.
constexpr std::int64_t kMaxNumber = 99'999'999;

/// The files of one frame; a path is empty where the file is absent.
struct SourceFrame {
  fs::path color, depth, pose;
};

/// Frames by the number in their file names.
using SourceFrames = std::map<std::int64_t, SourceFrame>;

/// Adds the file to its frame, if it belongs to one.
void add_file(const fs::path& file, SourceFrames& frames) {
  const std::string name = file.filename().string();
  if (!name.starts_with(kPrefix)) return;
  std::int64_t number = 0;
  const auto [end, code] =
      std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), number);
  if (code != std::errc{} || number < 0 || number > kMaxNumber) return;
  const std::string_view kind(end, name.data() + name.size());
  if (kind == ".color.png" || kind == ".color.jpg") frames[number].color = file;
  if (kind == ".depth.png") frames[number].depth = file;
  if (kind == ".pose.txt") frames[number].pose = file;
}

SourceFrames list_frames(const fs::path& source) {
  SourceFrames frames;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(source, code)) {
    add_file(entry.path(), frames);
  }
  return frames;
}

/// Exactly `count` finite numbers, separated by whitespace.
std::optional<std::vector<double>> read_numbers(const fs::path& file, std::size_t count) {
  const Expected<std::string> text = read_file(file);
  if (!text) return std::nullopt;
  std::vector<double> numbers;
  LineReader lines(*text);
  while (std::optional<std::string_view> line = lines.next()) {
    for (std::string_view rest = trimmed(*line); !rest.empty();) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      const std::optional<double> number = parse_number(rest.substr(0, end));
      if (!number) return std::nullopt;
      numbers.push_back(*number);
      rest = trimmed(rest.substr(end));
    }
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

/// nullopt where tracking was lost: no file, numbers that are not finite, or not a rigid
/// transformation.
std::optional<Pose> read_pose(const fs::path& file) {
  const std::optional<std::vector<double>> numbers = read_numbers(file, 16);
  if (!numbers) return std::nullopt;
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  // The poses are written with 7 digits and are orthonormal to about 1e-4; invalid ones are far
  // off.
  constexpr double kTolerance = 0.01;
  const Eigen::Matrix3d error = R * R.transpose() - Eigen::Matrix3d::Identity();
  const Eigen::RowVector4d last_row(0.0, 0.0, 0.0, 1.0);
  const bool is_rigid = error.cwiseAbs().maxCoeff() < kTolerance && R.determinant() > 0.0 &&
                        (matrix.row(3) - last_row).cwiseAbs().maxCoeff() < kTolerance;
  if (!is_rigid) return std::nullopt;
  return Pose::from_matrix(matrix);
}

/// The camera of the options or of the folder; the images' size from a depth image.
Expected<CameraModel> find_camera(const fs::path& source, const fs::path& depth_file,
                                  const ImportOptions& options) {
  if (options.camera) return *options.camera;
  const Expected<std::string> bytes = read_file(depth_file);
  if (!bytes) return bytes.error();
  const Expected<PngImage> header = decode_png_header(*bytes);
  if (!header) {
    return Error{.message = "can't be decoded: " + header.error().message,
                 .file = depth_file.string(),
                 .hint = "replace the image"};
  }
  CameraModel camera{.width = header->width, .height = header->height};
  const fs::path file = source / "camera-intrinsics.txt";
  std::error_code code;
  if (!fs::exists(file, code)) {
    // The values are as published, for images of 640 x 480; smaller copies of the dataset are in
    // use too.
    camera.fx = camera.fy = 585.0 * camera.width / 640.0;
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
    return camera;
  }
  const std::optional<std::vector<double>> K = read_numbers(file, 9);
  if (!K || !((*K)[0] > 0.0) || !((*K)[4] > 0.0)) {
    return Error{.message = "is not a camera matrix",
                 .file = file.string(),
                 .hint = "write fx 0 cx 0 fy cy 0 0 1, or give --camera"};
  }
  camera.fx = (*K)[0];
  camera.cx = (*K)[2];
  camera.fy = (*K)[4];
  camera.cy = (*K)[5];
  if (const std::optional<CameraFault> fault = find_camera_fault(camera)) {
    return Error{.message = fault->message, .file = file.string(), .hint = fault->hint};
  }
  return camera;
}

/// The depth image with 0 where nothing was measured.
Expected<EncodedImage> convert_depth(const fs::path& file, const CameraModel& camera,
                                     ImageDecoder& decoder) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  Expected<RawDepthImage> depth =
      decoder.raw_depth(*bytes, {file.string(), camera.width, camera.height});
  if (!depth) return depth.error();
  const std::span<std::uint16_t> pixels = depth->pixels();
  std::replace(pixels.begin(), pixels.end(), kInvalidDepth, std::uint16_t{0});
  return EncodedImage{encode_depth(*depth), ".png"};
}

/// Removes the frames without both images, and returns their number.
std::size_t remove_incomplete(SourceFrames& frames) {
  return std::erase_if(frames, [](const auto& frame) {
    return frame.second.color.empty() || frame.second.depth.empty();
  });
}

Expected<void> add_frame(const SourceFrame& frame, Stamp stamp, const CameraModel& camera,
                         ImageDecoder& decoder, RecordingWriter& writer) {
  Expected<std::string> color = read_file(frame.color);
  if (!color) return color.error();
  const Expected<EncodedImage> depth = convert_depth(frame.depth, camera, decoder);
  if (!depth) return depth.error();
  return writer.add_encoded_frame(stamp, {*std::move(color), frame.color.extension().string()},
                                  stamp, *depth);
}

}  // namespace

bool has_seven_scenes_frames(const fs::path& source) {
  const SourceFrames frames = list_frames(source);
  return std::any_of(frames.begin(), frames.end(),
                     [](const auto& frame) { return !frame.second.color.empty(); });
}

Expected<ImportReport> import_seven_scenes(const fs::path& source, const fs::path& target,
                                           const ImportOptions& options, const Observer& observer) {
  ImportReport report{.format = ImportFormat::seven_scenes};
  SourceFrames frames = list_frames(source);
  report.left_out = remove_incomplete(frames);
  if (frames.empty()) return report;
  const Expected<CameraModel> camera = find_camera(source, frames.begin()->second.depth, options);
  if (!camera) return camera.error();
  std::vector<fs::path> depth_files;
  for (const auto& [number, frame] : frames) depth_files.push_back(frame.depth);
  report.depth_scale = choose_depth_scale(depth_files, *camera, report.format, options);
  RecordingWriter writer(target, {.camera = *camera, .depth_scale = report.depth_scale.used});
  ImageDecoder decoder;
  Trajectory T_base_camera;
  std::size_t done = 0;
  for (const auto& [number, frame] : frames) {
    const std::size_t index = done++;
    if (index < options.first || (index - options.first) % options.stride != 0) continue;
    const Stamp stamp = Stamp::from_seconds(static_cast<double>(number) / options.frame_rate);
    const Expected<void> added = add_frame(frame, stamp, *camera, decoder, writer);
    if (!added) return added.error();
    ++report.frames;
    const std::optional<Pose> pose = read_pose(frame.pose);
    if (pose) T_base_camera.append(stamp, *pose);
    report.poses_left_out += pose ? 0 : 1;
    observer.on_progress("import", done, frames.size());
  }
  report.poses = T_base_camera.size();
  if (!T_base_camera.empty()) {
    if (auto written = writer.write_groundtruth(T_base_camera); !written) return written.error();
  }
  if (auto finished = writer.finish(); !finished) return finished.error();
  return report;
}

}  // namespace pcavr
