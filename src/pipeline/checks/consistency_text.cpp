// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "consistency_text.hpp"

#include <numbers>

#include <fmt/core.h>

namespace pcavr {

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string metres(double length) { return number(length) + " m"; }

std::string measured(double length) { return fmt::format("{:.3g} m", length); }

std::string degrees(double angle) {
  return fmt::format("{:.1f} degrees", angle * 180.0 / std::numbers::pi);
}

std::string factor_over_frames(double factor, std::size_t frames) {
  std::string text = fmt::format("factor {:.{}f}", factor, factor < 100.0 ? 2 : 0);
  if (frames > 0) text += " over " + std::to_string(frames) + " frames";
  return text;
}

std::string key_of_marker(std::size_t marker) { return "markers[" + std::to_string(marker) + "]"; }

std::string key_of_object(const Manifest& manifest, const std::string& name) {
  for (std::size_t i = 0; i < manifest.objects.size(); ++i) {
    if (manifest.objects[i].name == name) return "objects[" + std::to_string(i) + "]";
  }
  return "objects: " + name;
}

}  // namespace pcavr
