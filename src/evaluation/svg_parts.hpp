// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// Elements of SVG drawings; lengths in the drawing's own units.
[[nodiscard]] std::string svg_attribute(const char* name, double value);
[[nodiscard]] std::string svg_line(const std::string& css_class, double x1, double y1, double x2,
                                   double y2);
[[nodiscard]] std::string svg_rectangle(const std::string& css_class, double x, double y,
                                        double width, double height);
[[nodiscard]] std::string svg_text(const std::string& css_class, double x, double y,
                                   const std::string& content, const std::string& more = {});

/// 1, 2 or 5 times a power of ten, so that the span has at most `max_steps` steps.
[[nodiscard]] double tick_step(double span, double max_steps = 6.0);
/// Multiples of the step from `low` to `high`.
[[nodiscard]] std::vector<double> ticks_between(double low, double high, double step);
/// Decimals that multiples of the step need.
[[nodiscard]] int decimals_of(double step);

/// One entry of a legend: a symbol and its label.
[[nodiscard]] std::string legend_line(const std::string& css_class, const std::string& label);
[[nodiscard]] std::string legend_area(const std::string& css_class, const std::string& label);
/// A triangle that points down.
[[nodiscard]] std::string legend_pin(bool is_hollow, const std::string& label);

}  // namespace pcavr
