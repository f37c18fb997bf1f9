// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/lerobot_dataset.hpp"

namespace pcavr {

/// The one video of a data set: all episodes' images, one after the other.
struct LerobotVideo {
  std::string codec;  ///< as FFmpeg names it
  int width = 0;      ///< [px] of its pictures: even
  int height = 0;     ///< [px]
  struct Channel {
    double min = 0.0, max = 0.0, mean = 0.0, std = 0.0;  ///< of 0 to 1
  };
  std::array<Channel, 3> channels = {};  ///< red, green, blue, over every tenth picture
  std::size_t counted = 0;               ///< pictures of these
};

/// Writes it to `file`, in a folder that exists. Errors: images of different sizes; one that does
/// not decode; no encoder; a full disk.
[[nodiscard]] Expected<LerobotVideo> write_lerobot_video(
    const std::vector<LerobotEpisode>& episodes, const std::filesystem::path& file,
    const Observer& observer);

}  // namespace pcavr
