// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// States the units of the depth images that an import writes, in a manifest that has depth_scale
/// and depth_offset of the template it began as. A template's own scale within a fifth of the
/// units is a corrected one, of a calibration or by hand: it stays, with its offset. Else the
/// units are stated, and no offset. Whether an offset was given up so.
[[nodiscard]] bool state_depth_units(double units_per_metre, Manifest& manifest);

}  // namespace pcavr
