// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// What a data set is sampled at without images and without a wish [1/s]: as in the data sets of
/// ALOHA, and slower than any tool and force sensor.
inline constexpr int kDefaultLerobotRate = 50;

/// What was so at one time of an episode, as a data set has it. Base frame.
struct LerobotFrame {
  std::array<float, 7> state{};   ///< of the tool: x, y, z [m], qx, qy, qz, qw
  std::array<float, 7> action{};  ///< the tool's next state: what it was commanded is not recorded
  std::array<float, 6> wrench{};  ///< that the tool exerts [N, N m], the mean over the frame's time
  std::int64_t phase = 0;         ///< index in kLerobotPhases, of the touched object
  bool contact = false;           ///< of the tool with an object
  /// Of the object that is touched, was last touched, or will be touched first: its sliding
  /// friction coefficient and its std; NaN where it is not known.
  float mu = 0.0F, mu_std = 0.0F;
  std::size_t image = 0;  ///< index in Recording::frames; without meaning where there are none
};

/// Without contact; touched and at rest; the same with 0.9 of the limiting static friction or more;
/// sliding.
inline constexpr std::array<const char*, 4> kLerobotPhases{"free", "static", "critical", "sliding"};

/// A recording as one episode.
struct LerobotEpisode {
  std::string task;  ///< what was done, in words
  int rate = 0;      ///< frames [1/s]
  std::vector<LerobotFrame> frames;
  /// The images' recording, without its series; no frames: it has no images.
  Recording recording;
};

struct LerobotOptions {
  /// Frames [1/s]; by default the images' median rate, rounded, or kDefaultLerobotRate.
  std::optional<int> rate = {};
  std::string task = {};  ///< by default "push NAME" of the objects that were touched
};

/// Identifies the contacts of a recording (goal friction), and samples it at equal times, from when
/// all of its streams have begun until one ends. `known` takes the place of what is identified of
/// an object. Errors: those of identification_input and identify; streams with less than two
/// frames' time in common. Thread-safe.
[[nodiscard]] Expected<LerobotEpisode> make_lerobot_episode(
    const Recording& recording, const IdentificationSources& sources, const ParameterTable& known,
    const IdentificationOptions& identification, const LerobotOptions& options,
    const Observer& observer = {});

struct LerobotSummary {
  std::size_t frames = 0;
  int rate = 0;             ///< [1/s]
  std::string video_codec;  ///< empty: no images
};

/// Writes a LeRobot data set v3.0 into a folder that exists: meta/, data/ (Parquet) and, where
/// there are images, videos/ (MP4), in one file each. At least one episode. Errors: episodes of
/// different rates, of which some have no images, or with images of different sizes; an image that
/// does not decode; a file that can't be written. The same input gives the same bytes.
[[nodiscard]] Expected<LerobotSummary> write_lerobot_dataset(
    const std::vector<LerobotEpisode>& episodes, const std::filesystem::path& folder,
    const Observer& observer = {});

}  // namespace pcavr
