// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "consistency_text.hpp"

#include <array>
#include <cstdio>
#include <numbers>

namespace pcavr {
namespace {

std::string print_number(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace

std::string number(double value) { return print_number("%.5g", value); }

std::string metres(double length) { return number(length) + " m"; }

std::string measured(double length) { return print_number("%.3g", length) + " m"; }

std::string degrees(double angle) {
  return print_number("%.1f degrees", angle * 180.0 / std::numbers::pi);
}

std::string factor_over_frames(double factor, std::size_t frames) {
  std::string text = "factor " + print_number(factor < 100.0 ? "%.2f" : "%.0f", factor);
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
