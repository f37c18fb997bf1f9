// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/serve/live_world.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"

#include "haptics/tabletop.hpp"

namespace pcavr::test {

inline HapticWorld a_box_on_a_table() {
  return std::move(HapticWorld::create(one_box_on_a_table())).value();
}

/// Start position of the tool: next to the box, without contact.
inline const Eigen::Vector3d kToolStart{-0.2, 0.0, 0.05};

inline LiveWorldOptions options_with_tool_start() {
  LiveWorldOptions options;
  options.p_base_tool_start = kToolStart;
  return options;
}

/// Moved by pages.
inline std::unique_ptr<LiveWorld> a_live_world() {
  return std::make_unique<LiveWorld>(a_box_on_a_table(), std::make_unique<RemoteDevice>(),
                                     options_with_tool_start());
}

}  // namespace pcavr::test
