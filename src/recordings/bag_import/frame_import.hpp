// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/recordings/bag_import/bag_selection.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "recordings/bag_import/bag_streams.hpp"

namespace pcavr {

/// A depth image, and the colour image that belongs to it; without depth both stamps are colour's.
struct FramePlan {
  Stamp depth, color;
};

struct FrameCounts {
  std::size_t frames = 0;
  std::size_t left_out = 0;
  std::string left_out_reason;
};

/// Depth and colour stamps that are mutual nearest neighbours at most 20 ms apart, by the options'
/// stride. Without colour, or without depth, each image is paired with its own stamp.
[[nodiscard]] std::vector<FramePlan> plan_frames(const BagStreams& streams,
                                                 const BagImportOptions& options);

/// Reads the bag for the planned images, and adds them to the recording in order. At most 256
/// images wait for another in memory. A frame of which an image is damaged is left out. Without
/// colour topic, frames are grey.
[[nodiscard]] Expected<FrameCounts> import_frames(
    const std::filesystem::path& bag, const BagSelection& selection, const StampRule& stamps,
    const std::vector<FramePlan>& plan, const CameraModel& camera, double depth_scale,
    RecordingWriter& writer, const Observer& observer);

}  // namespace pcavr
