// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/live_protocol.hpp"

namespace pcavr {

/// Decodes a server's message, as the page does.
[[nodiscard]] Expected<ServerMessage> decode_server_message(std::span<const std::uint8_t> bytes);

}  // namespace pcavr
