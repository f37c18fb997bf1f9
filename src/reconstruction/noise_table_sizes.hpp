// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Entries of NoiseTables: over depth, over the cosine of the incidence, and depths that share a
/// row of weights. Apart, because the kernels may include no more of it.
inline constexpr int kNoiseDepths = 1024;
inline constexpr int kNoiseCosines = 64;
inline constexpr int kNoiseDepthsPerWeight = 4;

}  // namespace pcavr
