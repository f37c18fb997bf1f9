// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {

/// The frames of `rgb.txt` and `depth.txt`, paired by time.
struct PairedImages {
  std::vector<FrameFiles> frames;  ///< at least one
  std::size_t unpaired_color = 0;
  std::size_t unpaired_depth = 0;
  RowReport color_report = {};  ///< of `rgb.txt`
  RowReport depth_report = {};
};

/// Reads both lists of `folder`, checks that the images exist, and pairs them by time.
[[nodiscard]] Expected<PairedImages> read_image_lists(const std::filesystem::path& folder,
                                                      const ReadOptions& options);

/// Reads `rgb.txt` alone: frames without depth.
[[nodiscard]] Expected<PairedImages> read_color_list(const std::filesystem::path& folder,
                                                     const ReadOptions& options);

}  // namespace pcavr
