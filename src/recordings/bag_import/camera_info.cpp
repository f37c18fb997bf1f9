// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "pcavr/recordings/bag_import/camera_images.hpp"

namespace pcavr {
namespace {

/// Largest offset of the image centre, as a share of the image's size: a lens is centred on its
/// sensor to some hundredths.
constexpr double kMaxOffCentre = 1.0 / 6.0;

/// The camera of the part of the sensor that the image has [REP 104]: the first of every `binning`
/// columns and rows.
CameraModel region_camera(CameraModel camera, const RosCameraInfo& info) {
  camera.fx /= info.binning_x;
  camera.fy /= info.binning_y;
  camera.cx = (camera.cx - info.region_x) / info.binning_x;
  camera.cy = (camera.cy - info.region_y) / info.binning_y;
  return camera;
}

bool is_centred(const CameraModel& camera) {
  return std::abs(camera.cx - 0.5 * (camera.width - 1)) < kMaxOffCentre * camera.width &&
         std::abs(camera.cy - 0.5 * (camera.height - 1)) < kMaxOffCentre * camera.height;
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Error region_error(const RosCameraInfo& info, const std::string& message) {
  return {.message =
              "camera info of " + size_text(info.width, info.height) + " pixels with binning " +
              size_text(info.binning_x, info.binning_y) + " and the region of interest " +
              size_text(info.region_width, info.region_height) + " at " +
              std::to_string(info.region_x) + ", " + std::to_string(info.region_y) + ": " + message,
          .hint = "give --camera with a calibration file of the images"};
}

/// `full`: by the message's matrix and size. The size should be the full sensor's; some drivers
/// state that of the image, with the matrix of either: which, the principal point shows.
Expected<CameraModel> image_camera(const CameraModel& full, const RosCameraInfo& info,
                                   ImageSize image) {
  const bool has_region = info.region_width > 0 && info.region_height > 0;
  const bool is_binned = info.binning_x > 1 || info.binning_y > 1;
  if (!has_region && !is_binned) return full;
  const ImageSize region = has_region ? ImageSize{info.region_width, info.region_height}
                                      : ImageSize{info.width, info.height};
  const ImageSize stated{info.width, info.height};
  const ImageSize part{region.width / info.binning_x, region.height / info.binning_y};
  const bool is_inside =
      info.region_x + region.width <= info.width && info.region_y + region.height <= info.height;
  if (image == ImageSize{}) image = is_inside ? part : stated;
  CameraModel adapted = region_camera(full, info);
  adapted.width = image.width;
  adapted.height = image.height;
  if (is_inside && image == part) return adapted;
  if (image != stated) {
    return region_error(info, "its image has " + size_text(part.width, part.height) +
                                  " pixels, but the images have " +
                                  size_text(image.width, image.height));
  }
  const bool is_same = adapted.fx == full.fx && adapted.fy == full.fy && adapted.cx == full.cx &&
                       adapted.cy == full.cy;
  if (is_same || (is_centred(full) && !is_centred(adapted))) return full;
  if (is_centred(adapted) && !is_centred(full)) return adapted;
  return region_error(info,
                      "whether its matrix is that of the full sensor or of the image is not "
                      "certain");
}

Expected<LensDistortion> lens_of(const RosCameraInfo& info) {
  const std::vector<double>& d = info.distortion;
  const std::string& model = info.distortion_model;
  const bool is_finite = std::all_of(d.begin(), d.end(), [](double k) { return std::isfinite(k); });
  const auto rest_is_zero = [&](std::size_t count) {
    return std::all_of(d.begin() + static_cast<std::ptrdiff_t>(std::min(count, d.size())), d.end(),
                       [](double k) { return k == 0.0; });
  };
  if (is_finite && model == "plumb_bob" && d.size() >= 4 && rest_is_zero(5)) {
    return LensDistortion(d[0], d[1], d[2], d[3], d.size() > 4 ? d[4] : 0.0);
  }
  if (is_finite && model == "rational_polynomial" && d.size() >= 8 && rest_is_zero(8)) {
    return LensDistortion(LensModel::rational, std::span(d).first(8));
  }
  if (is_finite && model == "equidistant" && d.size() >= 4 && rest_is_zero(4)) {
    return LensDistortion(LensModel::fisheye, std::span(d).first(4));
  }
  return Error{.message = "distortion model '" + model + "' with " + std::to_string(d.size()) +
                          " coefficients is not supported",
               .hint = "give --camera with a calibration file"};
}

}  // namespace

Expected<CameraModel> camera_of(const RosCameraInfo& info, bool is_rectified, ImageSize image) {
  CameraModel full{.width = info.width, .height = info.height};
  full.fx = is_rectified ? info.projection(0, 0) : info.intrinsics(0, 0);
  full.fy = is_rectified ? info.projection(1, 1) : info.intrinsics(1, 1);
  full.cx = is_rectified ? info.projection(0, 2) : info.intrinsics(0, 2);
  full.cy = is_rectified ? info.projection(1, 2) : info.intrinsics(1, 2);
  const bool is_calibrated = full.fx > 0.0 && full.fy > 0.0 && std::isfinite(full.fx + full.fy) &&
                             std::isfinite(full.cx + full.cy) && full.width > 0 && full.height > 0;
  if (!is_calibrated) {
    return Error{.message = "camera info is not calibrated: its focal length or size is 0",
                 .hint = "give --camera with a calibration file"};
  }
  Expected<CameraModel> camera = image_camera(full, info, image);
  if (!camera) return camera;
  const std::vector<double>& d = info.distortion;
  const bool is_none = std::all_of(d.begin(), d.end(), [](double k) { return k == 0.0; });
  if (is_rectified || (is_none && info.distortion_model != "equidistant")) return camera;
  const Expected<LensDistortion> lens = lens_of(info);
  if (!lens) return lens.error();
  camera->distortion = *lens;
  return camera;
}

}  // namespace pcavr
