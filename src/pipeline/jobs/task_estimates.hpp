// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/task_graph.hpp"

namespace pcavr {

/// Time and memory of a stage on a recording of this size: linear in its images and its samples of
/// tool and force. Good to a factor of some two, on the machine of docs/files.md.
[[nodiscard]] TaskEstimate estimate_task(TaskStage stage, std::size_t frames, std::size_t samples);

}  // namespace pcavr
