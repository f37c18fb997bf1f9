// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void link(std::string_view bytes) {
  const std::vector<std::uint8_t> content(bytes.begin(), bytes.end());
  const Expected<LinkMessage> message = decode_link_message(content);
  if (!message) {
    PCAVR_REQUIRE(!message.error().message.empty());
    return;
  }
  PCAVR_REQUIRE(link_version_of(content) == kLinkVersion);
  PCAVR_REQUIRE(encode(*message) == content);  // the encoding is canonical
}

}  // namespace pcavr::fuzz
