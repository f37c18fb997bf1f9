// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace pcavr {

// Constants of the glTF 2.0 specification, sections 3.6.2, 4.4 and 5.
inline constexpr std::uint32_t kGlbMagic = 0x46546C67;
inline constexpr std::uint32_t kGlbJsonChunk = 0x4E4F534A;
inline constexpr std::uint32_t kGlbBinaryChunk = 0x004E4942;
inline constexpr int kGlbUnsignedShort = 5123;
inline constexpr int kGlbUnsignedInt = 5125;
inline constexpr int kGlbFloat = 5126;
inline constexpr int kGlbArrayBuffer = 34962;
inline constexpr int kGlbElementArrayBuffer = 34963;

}  // namespace pcavr
