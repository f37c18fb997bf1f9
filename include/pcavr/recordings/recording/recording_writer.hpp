// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The bytes of an image file, and its extension with the dot.
struct EncodedImage {
  std::string bytes;
  std::string extension;
};

/// Writes a recording to an existing folder (an OutputFolder's, so that it appears atomically).
/// Add frames in ascending order of stamps (otherwise a ContractError), then call finish() once.
/// Every file is written atomically; a disk that is full or not writable is an Error. The inverse
/// of read_recording. Not thread-safe.
class RecordingWriter {
 public:
  RecordingWriter(std::filesystem::path folder, const Manifest& manifest);
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;

  /// Depth as 16-bit PNG in the manifest's scale (rounded; out of range becomes 0), colour as JPEG
  /// of quality 95.
  [[nodiscard]] Expected<void> add_frame(Stamp color_stamp, const ColorImage& color,
                                         Stamp depth_stamp, const DepthImage& depth);
  /// Adds encoded images unchanged.
  [[nodiscard]] Expected<void> add_encoded_frame(Stamp color_stamp, const EncodedImage& color,
                                                 Stamp depth_stamp, const EncodedImage& depth);
  /// Adds an encoded image of a recording without depth, unchanged. Not beside frames with depth.
  [[nodiscard]] Expected<void> add_encoded_color(Stamp stamp, const EncodedImage& color);
  /// Copies image files unchanged, with their extension.
  [[nodiscard]] Expected<void> add_frame_files(Stamp color_stamp,
                                               const std::filesystem::path& color_file,
                                               Stamp depth_stamp,
                                               const std::filesystem::path& depth_file);
  [[nodiscard]] Expected<void> write_groundtruth(const Trajectory& T_base_camera);
  [[nodiscard]] Expected<void> write_tool(const Trajectory& T_base_tool);
  [[nodiscard]] Expected<void> write_wrench(const std::vector<WrenchSample>& wrench);
  [[nodiscard]] Expected<void> write_joints(const JointLog& log);
  /// Writes the description that the manifest's robot names.
  [[nodiscard]] Expected<void> write_robot(const std::string& urdf);
  /// Writes an OBJ file that the manifest names.
  [[nodiscard]] Expected<void> write_object_mesh(const std::filesystem::path& relative_path,
                                                 const TriangleMesh& mesh_object);
  /// Writes the image lists and the manifest.
  [[nodiscard]] Expected<void> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
