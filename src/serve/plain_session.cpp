// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "http_session.hpp"
#include "redirecting_session.hpp"
#include "session.hpp"

namespace pcavr::network {

void begin_plain_session(Hub& hub, tcp::socket socket, Peer peer) {
  std::make_shared<HttpSession<PlainStream>>(hub, PlainStream(std::move(socket)),
                                             beast::flat_buffer{}, std::move(peer), false)
      ->begin();
}

void begin_redirecting_session(Hub& hub, PlainStream stream, beast::flat_buffer buffer, Peer peer) {
  std::make_shared<HttpSession<PlainStream>>(hub, std::move(stream), std::move(buffer),
                                             std::move(peer), true)
      ->begin();
}

}  // namespace pcavr::network
