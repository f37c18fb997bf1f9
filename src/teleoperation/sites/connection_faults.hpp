// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"

namespace pcavr {

/// Why an operator's site can't work with a robot's site, in words for its user.

[[nodiscard]] Error other_link_version(int version);
[[nodiscard]] Error rejected_by_robot(const LinkReject& rejected);
/// `scene`: this site's. Nothing if the robot's site is as needed.
[[nodiscard]] std::optional<Error> unusable_robot(const LinkWelcome& welcome,
                                                  const std::string& scene, bool has_same_objects,
                                                  bool needs_follower);
[[nodiscard]] Error key_not_accepted();
/// The error after the time for the first connection.
[[nodiscard]] Error not_connected(OperatorTransport::State state,
                                  const std::optional<std::string>& busy);

}  // namespace pcavr
