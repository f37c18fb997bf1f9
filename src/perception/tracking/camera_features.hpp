// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"

#include "camera_alignment.hpp"
#include "camera_surface.hpp"

namespace pcavr::tracking {

using Pyramid = std::vector<cv::Mat>;

[[nodiscard]] cv::Mat to_gray_mat(const ColorImage& color);

/// Image pyramid for optical flow; with derivatives if it is the template of many searches.
[[nodiscard]] Pyramid make_pyramid(const cv::Mat& gray, bool with_derivatives);

/// Corners [Shi & Tomasi 1994] where the surface is smooth, distributed over the image [px].
[[nodiscard]] std::vector<cv::Point2f> find_corners(const cv::Mat& gray, const CellGrid& grid,
                                                    const Surface& surface);

/// A corner of a keyframe and its 3D point.
struct Landmark {
  cv::Point2f pixel;
  Eigen::Vector3d p_model;  ///< [m]
  int outlier_frames = 0;   ///< consecutive frames in which it was an outlier
};

/// `T_depth_color` is that of the keyframe; corners without a surface are left out.
[[nodiscard]] std::vector<Landmark> make_landmarks(const std::vector<cv::Point2f>& corners,
                                                   const CellGrid& grid, const Surface& surface,
                                                   const CameraModel& camera,
                                                   const Pose& T_depth_color);

/// Tracks landmarks by pyramidal optical flow (KLT) [Lucas & Kanade 1981; Bouguet 2001], starting
/// at their projections with the predicted pose of the frame's colour camera.
[[nodiscard]] std::vector<FeatureMatch> track_landmarks(const Pyramid& model,
                                                        const std::vector<Landmark>& landmarks,
                                                        const Pyramid& frame,
                                                        const Pose& T_model_color,
                                                        const CameraModel& camera);

}  // namespace pcavr::tracking
