// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "streams.hpp"

namespace pcavr::network {

/// Redirects every request to https; `buffer` has the bytes that were read already.
void begin_redirecting_session(Hub& hub, PlainStream stream, beast::flat_buffer buffer, Peer peer);

}  // namespace pcavr::network
