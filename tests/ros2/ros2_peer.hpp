// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <unistd.h>

#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

namespace pcavr {

/// DDS on the loopback interface without multicast, in a domain of this process and its children.
/// A child has to be made before any participant of its parent: threads do not survive a fork.
inline DdsOptions loopback_options() {
  static const auto domain = static_cast<std::uint32_t>(20 + ::getpid() % 180);
  return {.domain = domain, .interface = "127.0.0.1", .peers = {"127.0.0.1"}, .multicast = false};
}

}  // namespace pcavr
