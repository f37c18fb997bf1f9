// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/evaluation/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/evaluation/html_text.hpp"

#include "svg_parts.hpp"

namespace pcavr {
namespace {

// The drawing's size and margins in its own units, about pixels on a desktop screen.
constexpr double kWidth = 640.0;
constexpr double kLeft = 70.0;
constexpr double kRight = 14.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 46.0;
constexpr double kChartHeight = 300.0;
/// As high as two stacked charts with the page's gap.
constexpr double kMapHeight = 703.0;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double span() const { return high - low; }
  [[nodiscard]] bool contains(double value) const { return value >= low && value <= high; }
};

/// Data to drawing coordinates.
class Canvas {
 public:
  explicit Canvas(const Plot& plot) : height_(plot.equal_axes ? kMapHeight : kChartHeight) {
    for (const PlotSeries& series : plot.series) {
      for (const double x : series.x) x_.include(x);
      for (const double y : series.y) y_.include(y);
    }
    if (plot.from_zero) x_.include(0.0);
    if (plot.from_zero || plot.y_from_zero) y_.include(0.0);
    if (plot.x_from) x_.low = *plot.x_from;
    if (plot.x_to > 0.0) x_.high = plot.x_to;
    if (plot.y_to > 0.0) y_.high = plot.y_to;
    ensure_min_span(x_);
    ensure_min_span(y_);
    if (plot.equal_axes) {
      make_equal();
    } else if (plot.y_to <= 0.0) {
      y_.high += 0.06 * y_.span();  // margin above the peak
    }
  }

  [[nodiscard]] double x(double value) const {
    return kLeft + (value - x_.low) / x_.span() * inner_width();
  }
  [[nodiscard]] double y(double value) const {
    return height_ - kBottom - (value - y_.low) / y_.span() * inner_height();
  }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] double inner_height() const { return height_ - kTop - kBottom; }
  [[nodiscard]] static double inner_width() { return kWidth - kLeft - kRight; }
  [[nodiscard]] const Range& x_range() const { return x_; }
  [[nodiscard]] const Range& y_range() const { return y_; }

 private:
  /// Ensures a minimum span.
  static void ensure_min_span(Range& range) {
    if (!(range.low <= range.high)) range = {0.0, 0.0};
    constexpr double kMinSpan = 0.01;  // 0.01 mm of error; 10 mm of a body's path
    if (range.span() < kMinSpan) range.high = range.low + kMinSpan;
  }

  void make_equal() {
    const double scale = 1.1 * std::max(x_.span() / inner_width(), y_.span() / inner_height());
    recentre(x_, scale * inner_width());
    recentre(y_, scale * inner_height());
  }

  static void recentre(Range& range, double span) {
    const double centre = 0.5 * (range.low + range.high);
    range = {centre - 0.5 * span, centre + 0.5 * span};
  }

  double height_;
  Range x_;
  Range y_;
};

std::string format_axes(const Plot& plot, const Canvas& canvas) {
  const double bottom = canvas.height() - kBottom;
  const double x_step = tick_step(canvas.x_range().span());
  const double y_step = plot.equal_axes ? x_step : tick_step(canvas.y_range().span());
  std::string svg;
  for (const double tick : ticks_between(canvas.x_range().low, canvas.x_range().high, x_step)) {
    svg += svg_line("grid", canvas.x(tick), kTop, canvas.x(tick), bottom);
    svg += svg_text("tick middle", canvas.x(tick), bottom + 17.0, fixed(tick, decimals_of(x_step)));
  }
  for (const double tick : ticks_between(canvas.y_range().low, canvas.y_range().high, y_step)) {
    svg += svg_line("grid", kLeft, canvas.y(tick), kWidth - kRight, canvas.y(tick));
    svg +=
        svg_text("tick end", kLeft - 7.0, canvas.y(tick) + 4.0, fixed(tick, decimals_of(y_step)));
  }
  svg += svg_text("label middle", kLeft + 0.5 * Canvas::inner_width(), canvas.height() - 8.0,
                  plot.x_label);
  const double middle = kTop + 0.5 * canvas.inner_height();
  svg += svg_text("label middle", 14.0, middle, plot.y_label,
                  " transform=\"rotate(-90 14 " + fixed(middle, 1) + ")\"");
  return svg;
}

std::string band_class(int kind) { return "band" + std::to_string(kind); }

std::string format_bands(const Plot& plot, const Canvas& canvas) {
  std::string svg;
  for (const PlotBand& band : plot.bands) {
    const Range& shown = canvas.x_range();
    if (band.to < shown.low || band.from > shown.high) continue;
    const double from = canvas.x(std::max(band.from, shown.low));
    // Minimum width of a single frame.
    const double width = std::max(1.0, canvas.x(std::min(band.to, shown.high)) - from);
    svg += svg_rectangle(band_class(band.kind), from, kTop, width, canvas.inner_height());
  }
  return svg;
}

/// Labels are at the top of their line; lower where they would overlap the previous one.
std::string format_marks(const Plot& plot, const Canvas& canvas) {
  constexpr double kLabelWidth = 22.0;
  constexpr double kLabelHeight = 14.0;
  std::string svg;
  double last = -kWidth;
  int level = 0;
  for (const PlotMark& mark : plot.marks) {
    if (!canvas.x_range().contains(mark.x)) continue;
    const double x = canvas.x(mark.x);
    level = x - last < kLabelWidth ? (level + 1) % 4 : 0;
    last = x;
    const double bottom = canvas.height() - kBottom;
    svg += svg_line("mark", x, kTop, x, bottom);
    svg += svg_text("tick", x + 4.0, kTop + 13.0 + level * kLabelHeight, mark.label);
  }
  return svg;
}

std::string format_pins(const Plot& plot, const Canvas& canvas) {
  std::string svg;
  for (const PlotPin& pin : plot.pins) {
    if (!canvas.x_range().contains(pin.x)) continue;
    const double x = canvas.x(pin.x);
    svg += "<path class=\"" + std::string(pin.is_hollow ? "hollow pin" : "pin") + "\" d=\"M" +
           fixed(x - 4.0, 1) + ' ' + fixed(kTop - 8.0, 1) + 'L' + fixed(x + 4.0, 1) + ' ' +
           fixed(kTop - 8.0, 1) + 'L' + fixed(x, 1) + ' ' + fixed(kTop - 1.0, 1) + "Z\"/>\n";
  }
  return svg;
}

std::string class_of(const PlotSeries& series) {
  return "s" + std::to_string(series.color) + (series.dashed ? " dashed" : "");
}

std::string format_series(const PlotSeries& series, const Canvas& canvas) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
      pen_down = false;
      continue;
    }
    path += (pen_down ? 'L' : 'M') + fixed(canvas.x(series.x[i]), 1) + ' ' +
            fixed(canvas.y(series.y[i]), 1);
    pen_down = true;
  }
  return "<path class=\"" + class_of(series) + "\" d=\"" + path + "\"/>\n";
}

std::string format_legend(const Plot& plot) {
  std::string html = "<p class=\"legend\">";
  for (const PlotSeries& series : plot.series) html += legend_line(class_of(series), series.label);
  for (std::size_t kind = 0; kind < plot.band_labels.size(); ++kind) {
    const bool is_used = std::any_of(
        plot.bands.begin(), plot.bands.end(),
        [&](const PlotBand& band) { return static_cast<std::size_t>(band.kind) == kind; });
    if (is_used) html += legend_area(band_class(static_cast<int>(kind)), plot.band_labels[kind]);
  }
  for (const bool is_hollow : {false, true}) {
    const bool is_used = std::any_of(plot.pins.begin(), plot.pins.end(), [&](const PlotPin& pin) {
      return pin.is_hollow == is_hollow;
    });
    if (is_used) html += legend_pin(is_hollow, is_hollow ? plot.hollow_pin_label : plot.pin_label);
  }
  return html + "</p>\n";
}

}  // namespace

std::string format_figure(const Plot& plot) {
  const Canvas canvas(plot);
  std::string drawing = format_bands(plot, canvas) + format_axes(plot, canvas);
  // Nested, so that content outside the axes is clipped.
  drawing += "<svg" + svg_attribute("x", kLeft) + svg_attribute("y", kTop) +
             svg_attribute("width", Canvas::inner_width()) +
             svg_attribute("height", canvas.inner_height()) + " viewBox=\"" + fixed(kLeft, 1) +
             ' ' + fixed(kTop, 1) + ' ' + fixed(Canvas::inner_width(), 1) + ' ' +
             fixed(canvas.inner_height(), 1) + "\">\n";
  for (const PlotSeries& series : plot.series) drawing += format_series(series, canvas);
  drawing += "</svg>\n" + format_marks(plot, canvas) + format_pins(plot, canvas);
  drawing += "<rect class=\"frame\"" + svg_attribute("x", kLeft) + svg_attribute("y", kTop) +
             svg_attribute("width", Canvas::inner_width()) +
             svg_attribute("height", canvas.inner_height()) + "/>\n";
  return "<figure" + std::string(plot.equal_axes ? " class=\"map\"" : "") + ">\n<figcaption>" +
         escaped(plot.title) + "</figcaption>\n" + format_legend(plot) +
         "<svg class=\"plot\" role=\"img\" aria-label=\"" + escaped(plot.title) +
         "\" viewBox=\"0 0 " + fixed(kWidth, 0) + ' ' + fixed(canvas.height(), 0) + "\">\n" +
         drawing + "</svg>\n</figure>\n";
}

}  // namespace pcavr
