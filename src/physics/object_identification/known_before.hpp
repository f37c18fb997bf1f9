// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// Whether what a push showed under the first still holds under the second: laws and supports are
/// the same, and values differ by at most a fifth of their std, so that what follows from them
/// does, too.
[[nodiscard]] bool is_unchanged(const PushEvidence::Slide& shown,
                                const ContactCompliance& compliance, const KnownSupport& support);
[[nodiscard]] bool is_unchanged(const PushedObject& shown, const PushedObject& object);

}  // namespace pcavr
