// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/texture/texture_options.hpp"

namespace pcavr {

/// A frame that a texture may be made from.
struct ViewCandidate {
  std::size_t frame = 0;  ///< in Recording::frames
  Stamp stamp;
  Pose T_base_camera;
  double sharpness = 0.0;  ///< mean magnitude of the gradient [1/px, of 255]
  MaskImage is_dynamic;    ///< empty: no pixel
  ColorImage color;        ///< empty: to be decoded again
  DepthImage depth;        ///< [m]; empty where `color` is
};

/// Mean magnitude of the luma's gradient: motion and defocus lower it. Comparable between images of
/// the same part of a scene only.
[[nodiscard]] double sharpness_of(const ColorImage& color);

/// Chooses views while the frames pass by: of those near each other in space and time the sharpest.
/// Keeps at most twice the maximum number of candidates: where there are more, the distances are
/// doubled and the candidates are thinned out. Keeps their images as long as those of all
/// candidates fit into max_view_memory, so that those of a short recording are not decoded twice.
class ViewSelection {
 public:
  explicit ViewSelection(const TextureOptions& options = {});

  /// Frames in the order of their stamps. `is_dynamic` is of the depth image's size.
  void add(std::size_t frame, Stamp stamp, const Pose& T_base_camera, const ColorImage& color,
           const DepthImage& depth, const MaskImage& is_dynamic);

  /// At most max_views chosen views, in the order of their stamps; fewer where their images
  /// (`bytes_per_view`) would exceed max_view_memory. Leaves the selection without candidates.
  [[nodiscard]] std::vector<ViewCandidate> take_chosen(std::size_t bytes_per_view);

 private:
  [[nodiscard]] bool are_near(const ViewCandidate& a, const ViewCandidate& b, double scale) const;
  void thin_out();
  /// Keeps a copy of the images with the last candidate, or drops those of all for good.
  void keep_images(const ColorImage& color, const DepthImage& depth);
  [[nodiscard]] std::size_t max_memory() const;  ///< [bytes]

  TextureOptions options_;
  double scale_ = 1.0;  ///< of the distances
  bool keeps_images_ = true;
  std::vector<ViewCandidate> candidates_;
};

}  // namespace pcavr
