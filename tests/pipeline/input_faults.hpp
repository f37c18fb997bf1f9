// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/pipeline/identify.hpp"

/// Faults to inject into a sound recording, and the error that each must cause.
namespace pcavr {

using Change = std::function<void(IdentificationInput&)>;

/// One fault, and a part of the expected error message.
struct Fault {
  const char* name;
  Change apply;
  const char* expected_text;
};

inline Change scale_force(double factor) {
  return [factor](IdentificationInput& input) {
    for (Eigen::Vector3d& force : input.force_base) force *= factor;
  };
}

inline void flip_sign(IdentificationInput& input) { scale_force(-1.0)(input); }

inline void swap_x_and_y(IdentificationInput& input) {
  for (Eigen::Vector3d& force : input.force_base) std::swap(force.x(), force.y());
}

inline void write_in_tool_axes(IdentificationInput& input) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < input.force_base.size(); ++i) {
    while (k + 1 < input.t_tool.size() && input.t_tool[k] < input.t_force[i]) ++k;
    input.force_base[i] = input.q_base_tool[k].conjugate() * input.force_base[i];
  }
}

inline void write_tool_in_millimetres(IdentificationInput& input) {
  for (Eigen::Vector3d& p : input.p_base_tip) p *= 1e3;
}

inline Change delay_force(double late) {
  return [late](IdentificationInput& input) {
    for (double& t : input.t_force) t += late;
  };
}

inline const std::vector<Fault>& faults() {
  static const std::vector<Fault> all{
      {"millinewtons", scale_force(1e3), "another unit"},
      {"grams-force", scale_force(1e3 / kStandardGravity), "another unit"},
      {"kilonewtons", scale_force(1e-3), "another unit"},
      {"sign", flip_sign, "wrong sign"},
      {"swapped axes", swap_x_and_y, "other axes"},
      {"tool axes", write_in_tool_axes, "tool's axes"},
      {"millimetres", write_tool_in_millimetres, "in millimetres"},
      {"five seconds late", delay_force(5.0), "s later than the tool's motion"},
      {"five seconds early", delay_force(-5.0), "s earlier than the tool's motion"},
      {"another clock", delay_force(1000.0), "do not overlap"},
  };
  return all;
}

/// Whether a message reports one of these faults: not allowed for a sound recording.
inline bool reports_fault(const std::string& text) {
  static const char* const kFaultTexts[] = {"unit",    "sign",      "axes",    "in millimetres",
                                            "s later", "s earlier", "overlap", "one clock"};
  return std::any_of(std::begin(kFaultTexts), std::end(kFaultTexts),
                     [&](const char* part) { return text.find(part) != std::string::npos; });
}

}  // namespace pcavr
