// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "exposure.hpp"
#include "painted_view.hpp"

namespace pcavr {

/// Sets the vignetting, common to all views, by which they agree best on the points' colours
/// [Goldman & Chen 2005]: one Gauss-Newton step from the present one in logarithms, in which the
/// points' colours and the views' gains are eliminated. It stays where the camera's motion does not
/// show it.
void estimate_vignetting(std::vector<PaintedView>& views, const SeenColors& points);

}  // namespace pcavr
