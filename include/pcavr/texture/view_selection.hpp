// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/texture/texture_options.hpp"

namespace pcavr {

/// A frame that a texture may be made from; its images are decoded again when they are needed.
struct ViewCandidate {
  std::size_t frame = 0;  ///< in Recording::frames
  Stamp stamp;
  Pose T_base_camera;
  double sharpness = 0.0;  ///< mean magnitude of the gradient [1/px, of 255]
  MaskImage is_dynamic;    ///< empty: no pixel
};

/// Mean magnitude of the luma's gradient: motion and defocus lower it. Comparable between images of
/// the same part of a scene only.
[[nodiscard]] double sharpness_of(const ColorImage& color);

/// Chooses views while the frames pass by: of those near each other in space and time the sharpest.
/// Keeps at most twice the maximum number of candidates, without their images: where there are
/// more, the distances are doubled and the candidates are thinned out.
class ViewSelection {
 public:
  explicit ViewSelection(const TextureOptions& options = {});

  /// Frames in the order of their stamps. `is_dynamic` is of the depth image's size.
  void add(std::size_t frame, Stamp stamp, const Pose& T_base_camera, const ColorImage& color,
           const MaskImage& is_dynamic);

  /// At most max_views of them, in the order of their stamps; fewer where their images
  /// (`bytes_per_view`) would exceed max_view_memory.
  [[nodiscard]] std::vector<ViewCandidate> chosen(std::size_t bytes_per_view) const;

 private:
  [[nodiscard]] bool are_near(const ViewCandidate& a, const ViewCandidate& b, double scale) const;
  [[nodiscard]] std::vector<ViewCandidate> thinned(double scale) const;

  TextureOptions options_;
  double scale_ = 1.0;  ///< of the distances
  std::vector<ViewCandidate> candidates_;
};

}  // namespace pcavr
