// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <span>

#include "pcavr/base/core/check.hpp"
#include "pcavr/serve/live_protocol.hpp"

#include "fuzz/targets.hpp"
#include "serve/server_message_reader.hpp"

namespace pcavr::fuzz {

void live(std::string_view bytes) {
  const std::span content(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  if (const auto message = decode_page_message(content)) {
    const auto reparsed = decode_page_message(encode(*message));
    PCAVR_REQUIRE(reparsed && reparsed->content.index() == message->content.index());
    PCAVR_REQUIRE(encode(*reparsed) == encode(*message));
  } else {
    PCAVR_REQUIRE(!message.error().message.empty());
  }
  if (const auto message = decode_server_message(content)) {
    const auto reparsed = decode_server_message(encode(*message));
    PCAVR_REQUIRE(reparsed && encode(*reparsed) == encode(*message));
  }
}

}  // namespace pcavr::fuzz
