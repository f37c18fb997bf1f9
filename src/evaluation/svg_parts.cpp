// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "svg_parts.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/evaluation/html_text.hpp"
#include "pcavr/geometry/pixel.hpp"

namespace pcavr {
namespace {

std::string legend_entry(const std::string& drawing, const std::string& label) {
  return "<span><svg class=\"key\" viewBox=\"0 0 24 8\" aria-hidden=\"true\">" + drawing +
         "</svg>" + escaped(label) + "</span>\n";
}

}  // namespace

std::string svg_attribute(const char* name, double value) {
  return ' ' + std::string(name) + "=\"" + fixed(value, 1) + '"';
}

std::string svg_line(const std::string& css_class, double x1, double y1, double x2, double y2) {
  return "<line class=\"" + css_class + '"' + svg_attribute("x1", x1) + svg_attribute("y1", y1) +
         svg_attribute("x2", x2) + svg_attribute("y2", y2) + "/>\n";
}

std::string svg_rectangle(const std::string& css_class, double x, double y, double width,
                          double height) {
  return "<rect class=\"" + css_class + '"' + svg_attribute("x", x) + svg_attribute("y", y) +
         svg_attribute("width", width) + svg_attribute("height", height) + "/>\n";
}

std::string svg_text(const std::string& css_class, double x, double y, const std::string& content,
                     const std::string& more) {
  return "<text class=\"" + css_class + '"' + svg_attribute("x", x) + svg_attribute("y", y) + more +
         '>' + escaped(content) + "</text>\n";
}

double tick_step(double span, double max_steps) {
  const double rough = span / max_steps;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

/// More than fit on any axis.
constexpr int kMaxTicks = 1000;

std::vector<double> ticks_between(double low, double high, double step) {
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  // An integer counter: beyond 2^53 a double plus 1 is unchanged.
  const int count = clamp_to_int(last - first + 1.0, 0, kMaxTicks);
  for (int i = 0; i < count; ++i) ticks.push_back((first + i) * step);
  return ticks;
}

int decimals_of(double step) { return clamp_to_int(std::ceil(-std::log10(step) - 1e-9), 0, 9); }

std::string legend_line(const std::string& css_class, const std::string& label) {
  return legend_entry("<path class=\"" + css_class + "\" d=\"M0 4L24 4\"/>", label);
}

std::string legend_area(const std::string& css_class, const std::string& label) {
  return legend_entry("<rect class=\"" + css_class + "\" width=\"24\" height=\"8\"/>", label);
}

std::string legend_pin(bool is_hollow, const std::string& label) {
  return legend_entry("<path class=\"" + std::string(is_hollow ? "hollow pin" : "pin") +
                          "\" d=\"M8 0L16 0L12 7Z\"/>",
                      label);
}

}  // namespace pcavr
