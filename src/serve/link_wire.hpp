// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/serve/live_protocol.hpp"

namespace pcavr {

/// Writes the part of a state that describes the link, for `objects` objects. A robot's state has
/// as many objects: PCAVR_REQUIRE.
void write_link(const LiveLinkState& link, std::size_t objects, ByteWriter& writer);

}  // namespace pcavr
