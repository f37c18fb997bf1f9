// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Entries of NoiseTables: over depth, over the cosine of the incidence, and depths that share a
/// row of weights. A separate header, as the kernels must not include noise_tables.hpp.
inline constexpr int kNoiseDepths = 1024;
inline constexpr int kNoiseCosines = 64;
inline constexpr int kNoiseDepthsPerWeight = 4;

}  // namespace pcavr
