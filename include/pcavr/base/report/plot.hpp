// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcavr {

/// Columns of equal width into which a plot's line is decimated: about two per pixel on a wide
/// screen. More: zooming in shows more detail, and the file is larger.
inline constexpr int kPlotColumns = 2000;

/// A coordinate that breaks a line.
inline constexpr double kLineBreak = std::numeric_limits<double>::quiet_NaN();

/// A line through points; a NaN breaks it. Of any length: the page has at most the minimum and the
/// maximum of each of kPlotColumns columns (write_report_page), so that no peak is lost.
struct PlotSeries {
  std::string label;
  int color = 0;  ///< 0 to 3: of the page's colour-blind-safe palette
  std::vector<double> x = {};
  std::vector<double> y = {};
  bool dashed = false;
  bool points = false;  ///< marks the points instead of connecting them; not decimated
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
  bool equal_axes = false;            ///< same scale on both axes: a map, not decimated
  /// Drawn below the plot on axes of its own; its label is that of its y axis.
  std::optional<PlotSeries> strip = {};
  std::string strip_x_label = {};
  /// Lower limit of the x axis; the data's minimum where empty.
  std::optional<double> x_from = {};
  /// Upper limits of the x and y axis; the data's maximum where 0.
  double x_to = 0.0;
  double y_to = 0.0;
};

/// A coloured interval of a lane.
struct LaneInterval {
  double from = 0.0;
  double to = 0.0;
  int kind = 0;  ///< 0 to 3: one of the page's shades, and of the chart's kind_labels
};

/// One row of a lane chart.
struct Lane {
  std::string group;  ///< lanes of one group follow each other
  std::string label;
  std::vector<LaneInterval> intervals = {};
};

/// Intervals in rows above one another, over one x axis.
struct LaneChart {
  std::string title;
  std::string x_label;
  std::vector<std::string> kind_labels = {};  ///< by kind
  std::vector<Lane> lanes = {};
};

}  // namespace pcavr
