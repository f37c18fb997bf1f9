// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void trace(std::string_view bytes) {
  const Expected<std::vector<TraceSample>> samples = parse_trace(bytes, "the-file");
  if (!samples) {
    const Error& error = samples.error();
    PCAVR_REQUIRE(error.file == "the-file" && !error.message.empty() && !error.hint.empty(),
                  error.to_string());
    PCAVR_REQUIRE(error.line > 0 || error.message == "is empty" || error.message == "has no rows");
    return;
  }
  // The device checks the samples and plays them back.
  TraceDevice device(*samples);
  const double end = device.duration();
  for (const double t : {0.0, 0.001, 0.5 * end, end, 2.0 * end + 1.0}) {
    const DeviceSample sample = device.exchange(t, 0.001, {});
    PCAVR_REQUIRE(sample.p_base_tip.allFinite() && sample.q_base_tool.coeffs().allFinite());
    PCAVR_REQUIRE(sample.is_present == (t <= end), t, end);
  }
}

}  // namespace pcavr::fuzz
