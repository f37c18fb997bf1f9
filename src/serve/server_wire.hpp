// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace pcavr {

// The numbers of a server's messages, which apps/viewer reads: docs/live-protocol.md.

inline constexpr std::array<std::string_view, 3> kLevels{"info", "warning", "error"};
inline constexpr unsigned kTimeScaleShift = 8;  // bits of the flags below it
inline constexpr double kPercents = 100.0;

enum StateFlag : std::uint32_t {
  kEngaged = 1,
  kOnHold = 2,
  kTouchesScan = 4,
  kHasTool = 8,
  kToolTaken = 16,
  kStopped = 32,
  kHasLink = 64,
  kCanUndoReset = 128,
  kToolWanted = 1U << 16U,
  kHasAsked = 1U << 17U,
  kRecording = 1U << 18U,
};

inline constexpr std::uint32_t kNoObject = 0xffff'ffff;

inline constexpr std::uint32_t kArmStopped = 1;
inline constexpr std::uint32_t kArmReached = 2;
inline constexpr std::uint32_t kArmHasNearest = 4;
inline constexpr std::uint32_t kArmNearItself = 8;

enum LinkFlag : std::uint32_t {
  kConnected = 1,
  kHasRobot = 2,
  kRobotOnHold = 4,
  kRobotStopped = 8,
  kHasDelays = 16,
};

}  // namespace pcavr
