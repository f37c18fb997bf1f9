// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <span>

#include "pcavr/core/check.hpp"
#include "pcavr/serve/live_protocol.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void live(std::string_view bytes) {
  const std::span content(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  if (const auto message = decode_page_message(content)) {
    const auto again = decode_page_message(encode(*message));
    PCAVR_REQUIRE(again && again->content.index() == message->content.index());
    PCAVR_REQUIRE(encode(*again) == encode(*message));
  } else {
    PCAVR_REQUIRE(!message.error().message.empty());
  }
  if (const auto message = decode_server_message(content)) {
    const auto again = decode_server_message(encode(*message));
    PCAVR_REQUIRE(again && encode(*again) == encode(*message));
  }
}

}  // namespace pcavr::fuzz
