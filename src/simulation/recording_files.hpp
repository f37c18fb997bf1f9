// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/stamp.hpp"
#include "pcavr/recording/recording_writer.hpp"

#include "simulation/camera_path.hpp"
#include "simulation/push.hpp"
#include "simulation/world.hpp"

namespace pcavr::simulation {

/// What is really so, apart from what the sensors say of it.
struct Truth {
  const World& world;
  const CameraPath& camera;
  const PushRun& push;
  std::vector<Stamp> frames;
  double duration = 0.0;  ///< [s]
};

/// Writes `truth/` as the recording format has it.
[[nodiscard]] Expected<void> write_truth(const std::filesystem::path& folder, const Truth& truth);

/// Writes tool.csv and wrench.csv as an arm and its force sensor would report them: at 500 Hz, the
/// pose with 0.05 mm and 0.2 mrad of noise; the force as mean over 2 ms, stamped at their middle,
/// with noise, a bias that wanders by some 0.1 N, and rare spikes of one sample.
[[nodiscard]] Expected<void> write_tool_streams(RecordingWriter& writer, const Truth& truth,
                                                std::uint64_t seed);

}  // namespace pcavr::simulation
