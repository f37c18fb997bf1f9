// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ssl/context.hpp>

#include "network.hpp"

namespace pcavr::network {

/// Answers the requests of a connection until it ends; what a session needs of `hub` and `tls` must
/// outlive it.
void begin_plain_session(Hub& hub, tcp::socket socket, Peer peer);
/// The same on a TLS port: by the first bytes the client uses TLS, or plain HTTP, whose every
/// response is a redirect to https.
void begin_tls_session(Hub& hub, asio::ssl::context& tls, tcp::socket socket, Peer peer);

}  // namespace pcavr::network
