// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/devices/remote_device.hpp"
#include "pcavr/serve/live_world.hpp"

#include "haptics/tabletop.hpp"

namespace pcavr::test {

inline HapticWorld a_box_on_a_table() {
  return std::move(HapticWorld::create(one_box_on_a_table())).value();
}

/// Where the tool waits: beside the box, clear of all.
inline const Eigen::Vector3d kBeside{-0.2, 0.0, 0.05};

inline LiveWorldOptions beside_the_box() { return {.p_base_tool_start = kBeside}; }

/// Moved by pages.
inline std::unique_ptr<LiveWorld> a_live_world() {
  return std::make_unique<LiveWorld>(a_box_on_a_table(), std::make_unique<RemoteDevice>(),
                                     beside_the_box());
}

}  // namespace pcavr::test
