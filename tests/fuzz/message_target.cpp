// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/base/core/check.hpp"

#include "fuzz/targets.hpp"
#include "teleoperation/teleop/message.hpp"

namespace pcavr::fuzz {

void message(std::string_view bytes) {
  const std::vector<std::uint8_t> content(bytes.begin(), bytes.end());
  const std::optional<CorrectionMessage> message = decode(content, 0.0);
  if (!message) return;
  PCAVR_REQUIRE(encode(*message, 0.0) == content);  // the encoding is canonical
}

}  // namespace pcavr::fuzz
