// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"

namespace pcavr {

/// The sessions in the black box of a live site as a run: what was predicted, tracked, rendered and
/// corrected then, for `write_run`, `evaluate` and the page. Times are those of the scene [s]; of a
/// robot's site that plays a recording, from the recording's start. A log that was cut by a crash
/// is used up to its end. An Error if the file is no black box, or of another scene.
[[nodiscard]] Expected<Replay> read_logged_run(const std::filesystem::path& log,
                                               const SceneManifest& scene);

}  // namespace pcavr
