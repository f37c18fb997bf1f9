// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording/camera_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/decimal.hpp"

#include "recordings/recording/recording_text.hpp"

namespace pcavr {
namespace {

constexpr std::array kModels = {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye};

// Focal length over the image's longer side: from a pinhole with a field of view of 157 degrees to
// a telescope with half a degree. No depth camera lies beyond.
constexpr double kMinFocalRatio = 0.1;
constexpr double kMaxFocalRatio = 100.0;
/// Pixels are square within the tolerance of a calibration; binning in one direction only makes
/// them twice as long.
constexpr double kMaxAspect = 2.5;
/// The principal point lies in the image unless it was cropped: then at most this many widths or
/// heights outside.
constexpr double kMaxCropShift = 1.0;

LensModel model_of(const YamlValue& value) {
  const std::string word = value.text();
  const auto known = std::find_if(kModels.begin(), kModels.end(),
                                  [&](LensModel model) { return name_of(model) == word; });
  if (known == kModels.end()) {
    value.fail("is '" + word + "'", "write plumb_bob, rational or fisheye");
  }
  return *known;
}

std::string size_of(const CameraModel& camera) {
  return std::to_string(camera.width) + " x " + std::to_string(camera.height) + " image";
}

std::optional<CameraFault> focal_length_fault(const CameraModel& camera, CameraKey key) {
  const double focal_length = key == CameraKey::fx ? camera.fx : camera.fy;
  const int side = std::max(camera.width, camera.height);
  if (focal_length >= kMinFocalRatio * side && focal_length <= kMaxFocalRatio * side) return {};
  return CameraFault{key,
                     "a focal length of " + shortest_decimal(focal_length) +
                         " px is impossible for a " + size_of(camera),
                     "write pixels of the image's own size, as it was calibrated: " +
                         shortest_decimal(kMinFocalRatio * side) + " to " +
                         shortest_decimal(kMaxFocalRatio * side)};
}

std::optional<CameraFault> aspect_fault(const CameraModel& camera) {
  if (camera.fx <= kMaxAspect * camera.fy && camera.fy <= kMaxAspect * camera.fx) return {};
  return CameraFault{CameraKey::fy,
                     "fx is " + shortest_decimal(camera.fx) + " and fy is " +
                         shortest_decimal(camera.fy) + ": pixels are nearly square",
                     "correct the one that is wrong"};
}

std::optional<CameraFault> centre_fault(const CameraModel& camera, CameraKey key) {
  const double at = key == CameraKey::cx ? camera.cx : camera.cy;
  const int size = key == CameraKey::cx ? camera.width : camera.height;
  if (at >= -kMaxCropShift * size && at <= (1.0 + kMaxCropShift) * size) return {};
  return CameraFault{
      key,
      "a principal point at " + shortest_decimal(at) + " px lies too far from a " + size_of(camera),
      "write pixels of the image's own size, as it was calibrated: " +
          shortest_decimal(-kMaxCropShift * size) + " to " +
          shortest_decimal((1.0 + kMaxCropShift) * size)};
}

std::string in_degrees(double angle) {
  return std::to_string(std::lround(angle * 180.0 / std::numbers::pi)) + " degrees";
}

std::optional<CameraFault> lens_fault(const CameraModel& camera) {
  const std::optional<LensFold> fold = find_fold(camera);
  if (!fold) return {};
  const LensModel model = camera.distortion.model();
  const std::string names(coefficient_names(model));
  const std::string pixel = "(" + std::to_string(std::lround(fold->pixel.x())) + ", " +
                            std::to_string(std::lround(fold->pixel.y())) + ")";
  if (!fold->is_fold) {
    return CameraFault{CameraKey::distortion,
                       "pixel " + pixel + " looks more than " + in_degrees(fold->max_angle) +
                           " from the optical axis, where z-depth has no meaning",
                       "crop the images, or correct fx, fy and the coefficients " + names};
  }
  std::string hint = "check the order " + names;
  if (model == LensModel::plumb_bob) {
    hint += ", or write all eight coefficients of a rational lens with model: rational";
  }
  return CameraFault{CameraKey::distortion,
                     "folds inside the image, at pixel " + pixel +
                         ": the lens is one-to-one only up to " + in_degrees(fold->max_angle) +
                         " from the optical axis",
                     hint};
}

}  // namespace

std::string_view name_of(LensModel model) {
  switch (model) {
    case LensModel::plumb_bob:
      return "plumb_bob";
    case LensModel::rational:
      return "rational";
    case LensModel::fisheye:
      return "fisheye";
  }
  return "";
}

LensDistortion distortion_of(const YamlValue& value, LensModel model) {
  const std::size_t count = value.items().size();
  if (count != coefficient_count(model)) {
    value.fail("has " + std::to_string(count) + " numbers; a " + std::string(name_of(model)) +
                   " lens has " + std::to_string(coefficient_count(model)),
               "write " + std::string(coefficient_names(model)) + ", or correct the model");
  }
  return {model, value.numbers(count)};
}

std::optional<CameraFault> find_camera_fault(const CameraModel& camera) {
  for (const CameraKey key : {CameraKey::fx, CameraKey::fy}) {
    if (auto fault = focal_length_fault(camera, key)) return fault;
  }
  if (auto fault = aspect_fault(camera)) return fault;
  for (const CameraKey key : {CameraKey::cx, CameraKey::cy}) {
    if (auto fault = centre_fault(camera, key)) return fault;
  }
  return lens_fault(camera);
}

void check_camera(const CameraModel& camera, const CameraKeys& keys) {
  const std::optional<CameraFault> fault = find_camera_fault(camera);
  if (!fault) return;
  switch (fault->key) {
    case CameraKey::fx:
      keys.fx.fail(fault->message, fault->hint);
    case CameraKey::fy:
      keys.fy.fail(fault->message, fault->hint);
    case CameraKey::cx:
      keys.cx.fail(fault->message, fault->hint);
    case CameraKey::cy:
      keys.cy.fail(fault->message, fault->hint);
    case CameraKey::distortion:
      keys.distortion->fail(fault->message, fault->hint);
  }
}

CameraModel camera_of(const YamlValue& value) {
  CameraKeys keys{value.at("fx"), value.at("fy"), value.at("cx"), value.at("cy"),
                  value.find("distortion")};
  CameraModel camera{.width = value.at("width").integer(1, kMaxImageSide),
                     .height = value.at("height").integer(1, kMaxImageSide),
                     .fx = keys.fx.positive_number(),
                     .fy = keys.fy.positive_number(),
                     .cx = keys.cx.number(),
                     .cy = keys.cy.number()};
  const std::optional<YamlValue> model = value.find("model");
  const LensModel lens = model ? model_of(*model) : LensModel::plumb_bob;
  if (keys.distortion) {
    camera.distortion = distortion_of(*keys.distortion, lens);
  } else if (lens != LensModel::plumb_bob) {
    model->fail("is '" + std::string(name_of(lens)) + "', but the key distortion is missing",
                "add distortion: [" + std::string(coefficient_names(lens)) + "]");
  }
  check_camera(camera, keys);
  return camera;
}

}  // namespace pcavr
