// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"

#include "camera_alignment.hpp"
#include "camera_surface.hpp"

namespace pcavr::tracking {

using Pyramid = std::vector<cv::Mat>;

[[nodiscard]] cv::Mat gray_of(const ColorImage& color);

/// As optical flow wants it; with derivatives where it is to be searched for again and again.
[[nodiscard]] Pyramid make_pyramid(const cv::Mat& gray, bool with_derivatives);

/// Corners [Shi & Tomasi 1994] where the surface is smooth, spread over the image [px].
[[nodiscard]] std::vector<cv::Point2f> find_corners(const cv::Mat& gray, const CellGrid& grid,
                                                    const Surface& surface);

/// A corner of a keyframe and the point that it shows.
struct Landmark {
  cv::Point2f pixel;
  Eigen::Vector3d p_model;  ///< [m]
  int strayed = 0;          ///< how many frames in a row contradicted it
};

/// `T_depth_color` is the keyframe's own; corners without a surface under them are left out.
[[nodiscard]] std::vector<Landmark> make_landmarks(const std::vector<cv::Point2f>& corners,
                                                   const CellGrid& grid, const Surface& surface,
                                                   const CameraModel& camera,
                                                   const Pose& T_depth_color);

/// Finds landmarks again by pyramidal optical flow [Lucas & Kanade 1981; Bouguet 2001] from where
/// the predicted pose of the frame's colour camera puts them.
[[nodiscard]] std::vector<FeatureMatch> find_landmarks(const Pyramid& model,
                                                       const std::vector<Landmark>& landmarks,
                                                       const Pyramid& frame,
                                                       const Pose& T_model_color,
                                                       const CameraModel& camera);

}  // namespace pcavr::tracking
