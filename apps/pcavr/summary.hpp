// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/cycle_histogram.hpp"
#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/perception/scene/scene.hpp"

namespace pcavr::app {

using Counts = std::vector<std::pair<std::string, std::size_t>>;

/// The human-readable result of `pcavr build`.
[[nodiscard]] std::string scene_summary(const Scene& scene, const std::string& folder);
/// The same as JSON.
[[nodiscard]] nlohmann::ordered_json scene_json(const Scene& scene, const std::string& folder);

/// "118 of 120 used; camera lost 2".
[[nodiscard]] std::string frames_line(std::size_t recorded, std::size_t used,
                                      const Counts& dropped);
/// A line per stage with wall and CPU time.
[[nodiscard]] std::string times_table(const std::vector<StageTime>& times);
[[nodiscard]] nlohmann::ordered_json times_json(const std::vector<StageTime>& times);
/// Adds the quantiles of a world's cycles, "cycle_p999_s" and others, to the result.
void add_cycle_times(const CycleTimes& times, nlohmann::ordered_json& result);

}  // namespace pcavr::app
