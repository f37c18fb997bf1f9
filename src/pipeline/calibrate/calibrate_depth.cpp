// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "yaml_text.hpp"

namespace pcavr {
namespace {

/// Fewer places leave no residual that would say how good the fit is.
constexpr std::size_t kMinPlaces = 5;
/// The farthest tag over the nearest one, from which on an offset does not look like a scale.
constexpr double kMinDistanceRatio = 1.2;
/// Huber's threshold in standard deviations, 95 % efficient [Huber 1981].
constexpr double kHuber = 1.345;
/// A tag whose depth is off by this share and this many stds from what the others say is named.
constexpr double kMinTagError = 0.01, kMinTagStds = 4.0;
/// A correction within this many stds of none is none.
constexpr double kAgreeingStds = 2.0;

/// A tag from one place, the median of its images.
struct PlaceRow {
  std::size_t place = 0;
  std::string tag = {};
  double depth = 0.0;    ///< [m] measured
  double missing = 0.0;  ///< [m] the tags' less that
};

std::vector<PlaceRow> rows_of(const DepthViews& views) {
  std::map<std::pair<std::size_t, std::string>, std::vector<const DepthView*>> by_place;
  for (const DepthView& view : views.views) by_place[{view.place, view.tag}].push_back(&view);
  std::vector<PlaceRow> rows;
  for (const auto& [key, same] : by_place) {
    std::vector<double> depth, missing;
    for (const DepthView* view : same) {
      depth.push_back(view->by_depth);
      missing.push_back(view->by_tags - view->by_depth);
    }
    rows.push_back({key.first, key.second, median(depth), median(missing)});
  }
  return rows;
}

/// scale - 1 and offset [m].
using DepthCorrection = Eigen::Vector2d;

double error_left(const PlaceRow& row, const DepthCorrection& correction) {
  return correction[0] * row.depth + correction[1] - row.missing;
}

/// [m] Huber's threshold for these errors: by their median.
double threshold_of(const std::vector<PlaceRow>& rows, const DepthCorrection& correction) {
  std::vector<double> sizes;
  for (const PlaceRow& row : rows) sizes.push_back(std::abs(error_left(row, correction)));
  return std::max(kHuber * kStdOverMad * median(sizes), 1e-9);
}

DepthCorrection fit(const std::vector<PlaceRow>& rows, std::optional<std::size_t> without,
                    bool has_offset) {
  constexpr int kRounds = 20;
  DepthCorrection correction = DepthCorrection::Zero();
  for (int round = 0; round < kRounds; ++round) {
    const double threshold = threshold_of(rows, correction);
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const PlaceRow& row : rows) {
      if (row.place == without) continue;
      const double size = std::abs(error_left(row, correction));
      const double weight = round == 0 || size <= threshold ? 1.0 : threshold / size;
      const Eigen::Vector2d line(row.depth, has_offset ? 1.0 : 0.0);
      information += weight * line * line.transpose();
      right += weight * row.missing * line;
    }
    if (!has_offset) information(1, 1) = 1.0;
    correction = information.inverse() * right;
  }
  return correction;
}

double rms_of(const std::vector<PlaceRow>& rows, const DepthCorrection& correction) {
  double squares = 0.0;
  for (const PlaceRow& row : rows) squares += std::pow(error_left(row, correction), 2);
  return std::sqrt(squares / static_cast<double>(rows.size()));
}

/// The fit with each place left out once: the covariance, and the error of that place.
void leave_places_out(const std::vector<PlaceRow>& rows, const std::vector<std::size_t>& places,
                      DepthCalibration& found) {
  std::vector<DepthCorrection> corrections;
  DepthCorrection mean = DepthCorrection::Zero();
  double squares = 0.0;
  for (const std::size_t place : places) {
    corrections.push_back(fit(rows, place, found.has_offset));
    mean += corrections.back() / static_cast<double>(places.size());
    for (const PlaceRow& row : rows) {
      if (row.place == place) squares += std::pow(error_left(row, corrections.back()), 2);
    }
  }
  for (const DepthCorrection& correction : corrections) {
    found.covariance += (correction - mean) * (correction - mean).transpose();
  }
  const auto count = static_cast<double>(places.size());
  found.covariance *= (count - 1.0) / count;
  found.held_out_rms = std::sqrt(squares / static_cast<double>(rows.size()));
}

void describe_planes(const DepthViews& views, DepthCalibration& found) {
  std::vector<double> rms, tilts;
  std::map<int, DepthCell> sums;
  for (const DepthView& view : views.views) {
    rms.push_back(view.plane_rms);
    tilts.push_back(view.plane_tilt);
    for (const DepthCell& cell : view.cells) {
      DepthCell& sum = sums[cell.cell];
      sum.pixels += cell.pixels;
      sum.depth += cell.depth;
      sum.missing += cell.missing;
    }
  }
  found.plane_rms = median(std::move(rms));
  found.plane_tilt = median(std::move(tilts));
  found.cells.assign(std::size_t{kDepthCellColumns} * kDepthCellRows,
                     std::numeric_limits<double>::quiet_NaN());
  for (const auto& [number, sum] : sums) {
    found.cells[static_cast<std::size_t>(number)] =
        ((found.scale - 1.0) * sum.depth - sum.missing) / sum.pixels + found.offset;
  }
}

/// Tags that are nearer or farther by depth than all others say: of another size than stated.
void name_wrong_tags(const std::vector<PlaceRow>& rows, const DepthCorrection& correction,
                     DepthCalibration& found) {
  std::map<std::string, std::vector<double>> by_tag;
  for (const PlaceRow& row : rows)
    by_tag[row.tag].push_back(error_left(row, correction) / row.depth);
  if (by_tag.size() < 3) return;
  for (const auto& [tag, errors] : by_tag) {
    std::vector<double> others;
    for (const auto& [other, more] : by_tag) {
      if (other != tag) others.insert(others.end(), more.begin(), more.end());
    }
    const double middle = median(others);
    for (double& one : others) one = std::abs(one - middle);
    const double error = median(errors) - middle;
    const double limit = std::max(kMinTagError, kMinTagStds * kStdOverMad * median(others));
    if (std::abs(error) <= limit) continue;
    found.notes.push_back(
        fmt::format("{} is {:.1f} % {} by depth than the other tags say: check its size", tag,
                    100.0 * std::abs(error), error > 0.0 ? "farther" : "nearer"));
  }
}

Error too_few_places(const DepthViews& views, std::size_t places) {
  if (views.views.empty()) {
    return {.message = fmt::format("no tag with depth inside it is in {} images", views.frames),
            .hint = "record the tags large in the image, within the sensor's range"};
  }
  return {.message = fmt::format("the tags are seen from {} place{}, and {} are needed", places,
                                 places == 1 ? "" : "s", kMinPlaces),
          .hint = "move the camera to several distances from the tags, by 5 cm and more each"};
}

}  // namespace

Expected<DepthCalibration> calibrate_depth(const DepthViews& views) {
  const std::vector<PlaceRow> rows = rows_of(views);
  std::vector<std::size_t> places;
  for (const PlaceRow& row : rows) {
    if (places.empty() || places.back() != row.place) places.push_back(row.place);
  }
  if (places.size() < kMinPlaces) return too_few_places(views, places.size());
  DepthCalibration found;
  const auto [nearest, farthest] =
      std::minmax_element(rows.begin(), rows.end(), [](const PlaceRow& a, const PlaceRow& b) {
        return a.depth + a.missing < b.depth + b.missing;
      });
  found.nearest = nearest->depth + nearest->missing;
  found.farthest = farthest->depth + farthest->missing;
  found.has_offset = found.farthest >= kMinDistanceRatio * found.nearest;
  const DepthCorrection correction = fit(rows, std::nullopt, found.has_offset);
  leave_places_out(rows, places, found);
  found.scale = 1.0 + correction[0];
  found.offset = correction[1];
  found.scale_std = std::sqrt(found.covariance(0, 0));
  found.offset_std = std::sqrt(found.covariance(1, 1));
  found.depth_scale = views.depth_scale / found.scale;
  found.depth_offset = found.scale * views.depth_offset + found.offset;
  found.before_rms = rms_of(rows, DepthCorrection::Zero());
  found.fitted_rms = rms_of(rows, correction);
  describe_planes(views, found);
  if (!found.has_offset) {
    found.notes.push_back(fmt::format(
        "the offset is not observable: all tags are {:.2f} to {:.2f} m away; the scale holds there",
        found.nearest, found.farthest));
  }
  name_wrong_tags(rows, correction, found);
  found.notes.insert(found.notes.end(), views.notes.begin(), views.notes.end());
  return found;
}

std::string describe_depth(const DepthCalibration& found) {
  const double middle = 0.5 * (found.nearest + found.farthest);
  const double correction = (found.scale - 1.0) * middle + found.offset;
  const Eigen::Vector2d line(middle, 1.0);
  const double std = std::sqrt(line.dot(found.covariance * line));
  const UncertainText scale = uncertain(100.0 * (found.scale - 1.0), 100.0 * found.scale_std);
  const bool has_scale = std::abs(found.scale - 1.0) > kAgreeingStds * found.scale_std;
  const bool has_offset = std::abs(found.offset) > kAgreeingStds * found.offset_std;
  if (std::abs(correction) <= kAgreeingStds * std && !has_scale && !has_offset) {
    return fmt::format("the depth agrees with the tags, within {} mm",
                       readable(1e3 * found.held_out_rms));
  }
  return fmt::format(
      "the depth is {} mm too {} at {:.2f} m (scale {} +- {} %): corrected, {} mm are left",
      readable(1e3 * std::abs(correction)), correction > 0.0 ? "small" : "large", middle,
      scale.value, scale.std, readable(1e3 * found.held_out_rms));
}

std::string format_depth(const DepthCalibration& found, const DepthInput& input) {
  std::string text =
      "format: pcavr-calibration/1\nkind: depth\nsource: " + quoted(input.recording.string()) +
      '\n';
  const auto add = [&](const char* key, double value, const char* remark) {
    text += fmt::format("{}: {}  # {}\n", key, shortest_decimal(value), remark);
  };
  add("depth_scale", found.depth_scale, "units/m, in place of the camera's");
  add("depth_offset", found.depth_offset, "m, in place of the camera's");
  add("scale", found.scale, "true depth = scale * measured + offset");
  add("scale_std", found.scale_std, "by the places' scatter, with the tags' sizes taken as right");
  text += found.has_offset ? "" : "offset: ~  # not observable\n";
  if (found.has_offset) {
    add("offset", found.offset, "m");
    add("offset_std", found.offset_std, "m");
  }
  text += "covariance:  # of scale and offset (m)\n" + row_lists(found.covariance, "  ");
  add("nearest", found.nearest, "m, of the tags");
  add("farthest", found.farthest, "m");
  add("held_out_rms", found.held_out_rms, "m, of each place by the others");
  add("plane_rms", found.plane_rms, "m, of a tag's pixels about their plane");
  add("plane_tilt", found.plane_tilt, "rad, of that plane against the tag's");
  return text;
}

}  // namespace pcavr
