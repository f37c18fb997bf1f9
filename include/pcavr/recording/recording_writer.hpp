// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/mesh.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {

/// The bytes of an image file, and its extension with the dot.
struct EncodedImage {
  std::string bytes;
  std::string extension;
};

/// Writes a recording into a folder that exists (an OutputFolder's, so that it appears whole).
/// Add frames in ascending order of stamps, which is otherwise a ContractError, then finish() once.
/// Every file is written whole or not at all; a disk that is full or may not be written to is an
/// Error. What is written here, read_recording reads back. Not thread-safe.
class RecordingWriter {
 public:
  RecordingWriter(std::filesystem::path folder, const Manifest& manifest);
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;

  /// Depth as 16-bit PNG in the manifest's scale (rounded; out of range becomes 0), colour as JPEG
  /// of quality 95.
  [[nodiscard]] Expected<void> add_frame(Stamp color_stamp, const ColorImage& color,
                                         Stamp depth_stamp, const DepthImage& depth);
  /// Images as they are.
  [[nodiscard]] Expected<void> add_encoded_frame(Stamp color_stamp, const EncodedImage& color,
                                                 Stamp depth_stamp, const EncodedImage& depth);
  /// Copies image files as they are, keeping their extension.
  [[nodiscard]] Expected<void> add_frame_files(Stamp color_stamp,
                                               const std::filesystem::path& color_file,
                                               Stamp depth_stamp,
                                               const std::filesystem::path& depth_file);
  [[nodiscard]] Expected<void> write_groundtruth(const Trajectory& T_base_camera);
  [[nodiscard]] Expected<void> write_tool(const Trajectory& T_base_tool);
  [[nodiscard]] Expected<void> write_wrench(const std::vector<WrenchSample>& wrench);
  /// An OBJ file that the manifest names.
  [[nodiscard]] Expected<void> write_object_mesh(const std::filesystem::path& relative_path,
                                                 const TriangleMesh& mesh_object);
  /// Lists and manifest.
  [[nodiscard]] Expected<void> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
