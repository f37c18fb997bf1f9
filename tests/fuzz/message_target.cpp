// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/core/check.hpp"

#include "fuzz/targets.hpp"
#include "teleop/message.hpp"

namespace pcavr::fuzz {

void message(std::string_view bytes) {
  const std::vector<std::uint8_t> content(bytes.begin(), bytes.end());
  const std::optional<CorrectionMessage> message = decode(content, 0.0);
  if (!message) return;
  const std::vector<std::uint8_t> written = encode(*message, 0.0);
  PCAVR_REQUIRE(written.size() == content.size());
  PCAVR_REQUIRE(decode(written, 0.0).has_value());
}

}  // namespace pcavr::fuzz
