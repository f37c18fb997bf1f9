// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "html_text.hpp"

namespace pcavr {
namespace {

// The drawing's size and margins in its own units, about pixels on a desktop screen.
constexpr double kWidth = 640.0;
constexpr double kLeft = 70.0;
constexpr double kRight = 14.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 46.0;
constexpr double kChartHeight = 300.0;
/// As high as two charts above each other, with what the page sets between them.
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
};

/// 1, 2 or 5 times a power of ten, so that at most six steps make the span.
double tick_step(double span) {
  const double rough = span / 6.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

/// From data to the drawing.
class Canvas {
 public:
  explicit Canvas(const Plot& plot) : height_(plot.equal_axes ? kMapHeight : kChartHeight) {
    for (const PlotSeries& series : plot.series) {
      for (const double x : series.x) x_.include(x);
      for (const double y : series.y) y_.include(y);
    }
    if (plot.from_zero) {
      x_.include(0.0);
      y_.include(0.0);
    }
    if (plot.x_to > 0.0) x_.high = plot.x_to;
    if (plot.y_to > 0.0) y_.high = plot.y_to;
    make_wide(x_);
    make_wide(y_);
    if (plot.equal_axes) {
      make_equal();
    } else if (plot.y_to <= 0.0) {
      y_.high += 0.06 * y_.span();  // so that a peak does not touch the frame
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
  /// Gives a width to a range that has none.
  static void make_wide(Range& range) {
    if (!(range.low <= range.high)) range = {0.0, 0.0};
    constexpr double kSmallest = 0.01;  // 0.01 mm of error; 10 mm of a body's path
    if (range.span() < kSmallest) range.high = range.low + kSmallest;
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

std::string attribute(const char* name, double value) {
  return ' ' + std::string(name) + "=\"" + fixed(value, 1) + '"';
}

std::string line(const char* css_class, double x1, double y1, double x2, double y2) {
  return "<line class=\"" + std::string(css_class) + '"' + attribute("x1", x1) +
         attribute("y1", y1) + attribute("x2", x2) + attribute("y2", y2) + "/>\n";
}

std::string text(const char* css_class, double x, double y, const std::string& content,
                 const std::string& more = {}) {
  return "<text class=\"" + std::string(css_class) + '"' + attribute("x", x) + attribute("y", y) +
         more + '>' + escaped(content) + "</text>\n";
}

/// Multiples of the step inside the range.
std::vector<double> ticks_of(const Range& range, double step) {
  std::vector<double> ticks;
  const double first = std::ceil(range.low / step - 1e-9);
  const double last = std::floor(range.high / step + 1e-9);
  for (double i = first; i <= last; i += 1.0) ticks.push_back(i * step);
  return ticks;
}

int decimals_of(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
}

std::string format_axes(const Plot& plot, const Canvas& canvas) {
  const double bottom = canvas.height() - kBottom;
  const double x_step = tick_step(canvas.x_range().span());
  const double y_step = plot.equal_axes ? x_step : tick_step(canvas.y_range().span());
  std::string svg;
  for (const double tick : ticks_of(canvas.x_range(), x_step)) {
    svg += line("grid", canvas.x(tick), kTop, canvas.x(tick), bottom);
    svg += text("tick middle", canvas.x(tick), bottom + 17.0, fixed(tick, decimals_of(x_step)));
  }
  for (const double tick : ticks_of(canvas.y_range(), y_step)) {
    svg += line("grid", kLeft, canvas.y(tick), kWidth - kRight, canvas.y(tick));
    svg += text("tick end", kLeft - 7.0, canvas.y(tick) + 4.0, fixed(tick, decimals_of(y_step)));
  }
  svg += text("label middle", kLeft + 0.5 * Canvas::inner_width(), canvas.height() - 8.0,
              plot.x_label);
  const double middle = kTop + 0.5 * canvas.inner_height();
  svg += text("label middle", 14.0, middle, plot.y_label,
              " transform=\"rotate(-90 14 " + fixed(middle, 1) + ")\"");
  return svg;
}

std::string format_bands(const Plot& plot, const Canvas& canvas) {
  std::string svg;
  for (const PlotBand& band : plot.bands) {
    const double from = canvas.x(band.from);
    // A stretch of a single frame shows all the same.
    const double width = std::max(1.0, canvas.x(band.to) - from);
    svg += "<rect class=\"band\"" + attribute("x", from) + attribute("y", kTop) +
           attribute("width", width) + attribute("height", canvas.inner_height()) + "/>\n";
  }
  return svg;
}

std::string format_marks(const Plot& plot, const Canvas& canvas) {
  std::string svg;
  for (const PlotMark& mark : plot.marks) {
    const double x = canvas.x(mark.x);
    svg += line("mark", x, kTop, x, canvas.height() - kBottom);
    svg += text("tick", x + 4.0, canvas.height() - kBottom - 6.0, mark.label);
  }
  return svg;
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
  return "<path class=\"s" + std::to_string(series.color) + (series.dashed ? " dashed" : "") +
         "\" d=\"" + path + "\"/>\n";
}

std::string format_legend(const Plot& plot) {
  std::string html = "<p class=\"legend\">";
  for (const PlotSeries& series : plot.series) {
    html += "<span><svg class=\"key\" viewBox=\"0 0 24 8\" aria-hidden=\"true\"><path class=\"s" +
            std::to_string(series.color) + (series.dashed ? " dashed" : "") +
            "\" d=\"M0 4L24 4\"/></svg>" + escaped(series.label) + "</span>\n";
  }
  if (!plot.bands.empty()) {
    html +=
        "<span><svg class=\"key\" viewBox=\"0 0 24 8\" aria-hidden=\"true\"><rect class=\"band\" "
        "width=\"24\" height=\"8\"/></svg>" +
        escaped(plot.band_label) + "</span>\n";
  }
  return html + "</p>\n";
}

}  // namespace

std::string format_figure(const Plot& plot) {
  const Canvas canvas(plot);
  std::string drawing = format_bands(plot, canvas) + format_axes(plot, canvas);
  // Nested, so that what lies outside the axes is cut off.
  drawing += "<svg" + attribute("x", kLeft) + attribute("y", kTop) +
             attribute("width", Canvas::inner_width()) +
             attribute("height", canvas.inner_height()) + " viewBox=\"" + fixed(kLeft, 1) + ' ' +
             fixed(kTop, 1) + ' ' + fixed(Canvas::inner_width(), 1) + ' ' +
             fixed(canvas.inner_height(), 1) + "\">\n";
  for (const PlotSeries& series : plot.series) drawing += format_series(series, canvas);
  drawing += "</svg>\n" + format_marks(plot, canvas);
  drawing += "<rect class=\"frame\"" + attribute("x", kLeft) + attribute("y", kTop) +
             attribute("width", Canvas::inner_width()) +
             attribute("height", canvas.inner_height()) + "/>\n";
  return "<figure" + std::string(plot.equal_axes ? " class=\"map\"" : "") + ">\n<figcaption>" +
         escaped(plot.title) + "</figcaption>\n" + format_legend(plot) +
         "<svg class=\"plot\" role=\"img\" aria-label=\"" + escaped(plot.title) +
         "\" viewBox=\"0 0 " + fixed(kWidth, 0) + ' ' + fixed(canvas.height(), 0) + "\">\n" +
         drawing + "</svg>\n</figure>\n";
}

}  // namespace pcavr
