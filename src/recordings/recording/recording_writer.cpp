// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/recording_writer.hpp"

#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"

#include "recordings/recording/recording_text.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

Expected<void> create_parent(const fs::path& file) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  if (!code) return {};
  return Error{.message = "can't be created: " + code.message(),
               .file = file.parent_path().string(),
               .hint = "choose a folder that you may write to"};
}

/// Appends a line to an image list, and returns the image's path.
std::string append_to_list(Stamp stamp, const std::string& folder, const std::string& extension,
                           std::optional<Stamp>& last, std::string& text) {
  PCAVR_REQUIRE(!last || *last < stamp);
  last = stamp;
  const std::string time = format_file_stamp(stamp);
  std::string path = folder + time + extension;
  text += time + ' ' + quoted_field(path) + '\n';
  return path;
}

}  // namespace

struct RecordingWriter::State {
  fs::path folder;
  Manifest manifest;
  std::string color_list = "# colour images\n# timestamp path\n";
  std::string depth_list = "# depth images\n# timestamp path\n";
  std::optional<Stamp> last_color;
  std::optional<Stamp> last_depth;

  /// Writes a file at `relative`, and creates its folder where needed.
  [[nodiscard]] Expected<void> write(const fs::path& relative, std::string_view content) const {
    const fs::path file = folder / relative;
    if (Expected<void> made = create_parent(file); !made) return made;
    return write_file(file, content);
  }
};

RecordingWriter::RecordingWriter(fs::path folder, const Manifest& manifest)
    : state_(std::make_unique<State>()) {
  state_->folder = std::move(folder);
  state_->manifest = manifest;
}

namespace {

/// The depth as the sensor had it, from that with the manifest's offset.
DepthImage without_offset(DepthImage depth, double offset) {
  if (offset == 0.0) return depth;
  for (float& z : depth.pixels()) {
    if (z > 0.0F) z = std::max(0.0F, z - static_cast<float>(offset));
  }
  return depth;
}

}  // namespace

RecordingWriter::~RecordingWriter() = default;
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;

Expected<void> RecordingWriter::add_encoded_frame(Stamp color_stamp, const EncodedImage& color,
                                                  Stamp depth_stamp, const EncodedImage& depth) {
  PCAVR_REQUIRE(state_->manifest.camera.has_value());
  const std::string depth_path = append_to_list(depth_stamp, "depth/", depth.extension,
                                                state_->last_depth, state_->depth_list);
  if (Expected<void> written = add_encoded_color(color_stamp, color); !written) return written;
  return state_->write(depth_path, depth.bytes);
}

Expected<void> RecordingWriter::add_encoded_color(Stamp stamp, const EncodedImage& color) {
  PCAVR_REQUIRE(state_->manifest.camera.has_value());
  const std::string path =
      append_to_list(stamp, "rgb/", color.extension, state_->last_color, state_->color_list);
  return state_->write(path, color.bytes);
}

Expected<void> RecordingWriter::add_frame(Stamp color_stamp, const ColorImage& color,
                                          Stamp depth_stamp, const DepthImage& depth) {
  Expected<std::string> jpeg = encode_color(color);
  if (!jpeg) return jpeg.error();
  const RawDepthImage units = to_raw_depth(without_offset(depth, state_->manifest.depth_offset),
                                           state_->manifest.depth_scale);
  return add_encoded_frame(color_stamp, {*std::move(jpeg), ".jpg"}, depth_stamp,
                           {encode_depth(units), ".png"});
}

Expected<void> RecordingWriter::add_frame_files(Stamp color_stamp, const fs::path& color_file,
                                                Stamp depth_stamp, const fs::path& depth_file) {
  Expected<std::string> color = read_file(color_file);
  if (!color) return color.error();
  Expected<std::string> depth = read_file(depth_file);
  if (!depth) return depth.error();
  return add_encoded_frame(color_stamp, {*std::move(color), color_file.extension().string()},
                           depth_stamp, {*std::move(depth), depth_file.extension().string()});
}

Expected<void> RecordingWriter::write_groundtruth(const Trajectory& T_base_camera) {
  return state_->write("groundtruth.txt", format_trajectory(T_base_camera));
}

Expected<void> RecordingWriter::write_tool(const Trajectory& T_base_tool) {
  return state_->write("tool.csv", format_tool(T_base_tool));
}

Expected<void> RecordingWriter::write_wrench(const std::vector<WrenchSample>& wrench) {
  return state_->write("wrench.csv", format_wrench(wrench));
}

Expected<void> RecordingWriter::write_joints(const JointLog& log) {
  return state_->write("joints.csv", format_joint_log(log));
}

Expected<void> RecordingWriter::write_robot(const std::string& urdf) {
  PCAVR_REQUIRE(state_->manifest.robot.has_value());
  return state_->write(state_->manifest.robot->urdf, urdf);
}

Expected<void> RecordingWriter::write_object_mesh(const fs::path& relative_path,
                                                  const TriangleMesh& mesh_object) {
  return state_->write(relative_path, format_obj(mesh_object));
}

Expected<void> RecordingWriter::finish() {
  if (state_->last_color) {
    if (Expected<void> written = state_->write("rgb.txt", state_->color_list); !written) {
      return written;
    }
  }
  if (state_->last_depth) {
    if (Expected<void> written = state_->write("depth.txt", state_->depth_list); !written) {
      return written;
    }
  }
  const Expected<void> manifest =
      state_->write("recording.yaml", format_manifest(state_->manifest));
  return manifest ? write_line_counts(state_->folder) : manifest;
}

}  // namespace pcavr
