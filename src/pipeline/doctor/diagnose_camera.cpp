// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/core.h>

#include "pcavr/pipeline/doctor.hpp"

#include "diagnosis_rows.hpp"

namespace pcavr {
namespace {

/// Of usual cameras, from a telephoto to a fisheye lens [degrees].
constexpr double kNarrowView = 20.0, kWideView = 140.0;
/// Pixels of sensors are square to this share.
constexpr double kMaxPixelAspect = 0.02;
/// The principal point is within this share of the image's size from its middle.
constexpr double kMaxCentreShare = 0.1;

/// [degrees] Between the rays of two pixels.
double angle_between(const CameraModel& camera, const Eigen::Vector2d& a,
                     const Eigen::Vector2d& b) {
  const Eigen::Vector3d first = camera.normalise(a).homogeneous().normalized();
  const Eigen::Vector3d second = camera.normalise(b).homogeneous().normalized();
  return 180.0 / std::numbers::pi * std::acos(std::min(1.0, std::max(-1.0, first.dot(second))));
}

DiagnosisRow view_row(const CameraModel& camera) {
  const double right = camera.width - 1.0, bottom = camera.height - 1.0;
  const double across = angle_between(camera, {0.0, camera.cy}, {right, camera.cy});
  const double down = angle_between(camera, {camera.cx, 0.0}, {camera.cx, bottom});
  const std::string figure = fmt::format("fx {:.1f}, fy {:.1f} px: {:.1f} x {:.1f} degrees",
                                         camera.fx, camera.fy, across, down);
  if (across >= kNarrowView && across <= kWideView) return agreement("field of view", figure);
  return disagreement("field of view", figure,
                      "the intrinsics are of another resolution, or in another unit than pixels");
}

DiagnosisRow aspect_row(const CameraModel& camera) {
  const double aspect = camera.fx / camera.fy;
  const std::string figure = fmt::format("fx over fy is {:.4f}", aspect);
  if (std::abs(aspect - 1.0) <= kMaxPixelAspect) return agreement("square pixels", figure);
  return disagreement("square pixels", figure,
                      "the image was stretched, or fx and fy are of two resolutions");
}

DiagnosisRow centre_row(const CameraModel& camera) {
  const double x = camera.cx - 0.5 * (camera.width - 1.0),
               y = camera.cy - 0.5 * (camera.height - 1.0);
  const std::string figure = fmt::format("({:.1f}, {:.1f}) px from the image's middle", x, y);
  if (std::abs(x) <= kMaxCentreShare * camera.width &&
      std::abs(y) <= kMaxCentreShare * camera.height) {
    return agreement("principal point", figure);
  }
  return disagreement("principal point", figure,
                      "the intrinsics are of another resolution, or of an image that was cropped");
}

}  // namespace

DiagnosisReport diagnose_camera(const std::filesystem::path& file, const CameraFile& content) {
  const CameraModel& camera = content.camera;
  DiagnosisReport report;
  report.rows = {agreement("camera file", fmt::format("{} x {} px, {}", camera.width, camera.height,
                                                      name_of(camera.distortion.model()))),
                 view_row(camera), aspect_row(camera), centre_row(camera),
                 agreement("lens", camera.has_distortion() ? "one-to-one over the whole image"
                                                           : "no distortion is stated")};
  report.rows.push_back(
      content.depth_scale
          ? agreement("depth scale", fmt::format("{:.6g} units per metre", *content.depth_scale))
          : unchecked("depth scale", "not stated: for depth images it is needed"));
  report.rows.push_back(unchecked("against what the camera sees",
                                  "no images: pcavr calibrate camera compares it with a board"));
  report.next =
      "pcavr calibrate camera PICTURES --board BOARD -o CAMERA; or pcavr import FOLDER "
      "--camera '" +
      file.string() + "' -o RECORDING";
  return report;
}

}  // namespace pcavr
