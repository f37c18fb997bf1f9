// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/physics/identification/contact_fit.hpp"

namespace pcavr {

/// Whether a press is shorter than a window of such a surface: it has one stiffness.
[[nodiscard]] bool is_short_press(const ForceMotion& press, const ContactFitOptions& options);

/// The linear law of a surface that moves while it is pressed, as when a tip travels over tissue
/// that it presses periodically. Force and tip are taken about their moving means; windows of some
/// periods each give a stiffness, and the mean over the windows, which scatter, is returned,
/// without a surface. Not valid where there are too few windows.
[[nodiscard]] ContactFit fit_drifting_surface(std::span<const ForceMotion> presses,
                                              const ContactFitOptions& options);

}  // namespace pcavr
