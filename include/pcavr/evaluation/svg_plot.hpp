// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcavr {

/// A coordinate that breaks a line.
inline constexpr double kLineBreak = std::numeric_limits<double>::quiet_NaN();

/// A line through points; a NaN breaks it.
struct PlotSeries {
  std::string label;
  int color = 0;  ///< 0 to 3: of the page's colour-blind-safe palette
  std::vector<double> x = {};
  std::vector<double> y = {};
  bool dashed = false;
};

/// A shaded interval of the x axis.
struct PlotBand {
  double from = 0.0;
  double to = 0.0;
  int kind = 0;  ///< 0 to 3: one of the page's shades, and of the plot's band_labels
};

/// A dashed vertical line.
struct PlotMark {
  double x = 0.0;
  std::string label;
};

/// A small triangle at the upper edge.
struct PlotPin {
  double x = 0.0;
  bool is_hollow = false;
};

struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series = {};
  std::vector<PlotBand> bands = {};
  std::vector<std::string> band_labels = {};  ///< in the legend, by kind, of the used ones
  std::vector<PlotMark> marks = {};
  std::vector<PlotPin> pins = {};
  std::string pin_label = {};         ///< in the legend, where there are pins
  std::string hollow_pin_label = {};  ///< the same for hollow ones
  bool from_zero = false;             ///< both axes
  bool y_from_zero = false;           ///< the y axis
  bool equal_axes = false;            ///< same scale on both axes: a map
  /// Lower limit of the x axis; the data's minimum where empty.
  std::optional<double> x_from = {};
  /// Upper limits of the x and y axis; the data's maximum where 0.
  double x_to = 0.0;
  double y_to = 0.0;
};

/// The plot as an HTML figure with caption, legend and inline SVG; colours come from the page.
[[nodiscard]] std::string format_figure(const Plot& plot);

}  // namespace pcavr
