// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/recording/manifest.hpp"

namespace pcavr {

/// Four corners of a tag in the image [px; the centre of pixel (0, 0) is at (0, 0)], in the order
/// (-,-) (+,-) (+,+) (-,+) of the marker frame (x right, y up, seen upright).
struct TagDetection {
  MarkerId id;
  std::array<Eigen::Vector2d, 4> corners;
  int hamming = 0;               ///< bits corrected
  double decision_margin = 0.0;  ///< mean contrast between bits and threshold; small is doubtful
  /// Of one corner coordinate [px], as the picture's own noise and blur tell it; 0 where not known.
  double corner_sigma = 0.0;
};

struct TagDetectorOptions {
  int decimation = 2;        ///< >= 1; quads are sought in an image shrunk by this; corners are not
  int max_hamming = 1;       ///< 0 to 3; tags with more corrected bits are dropped
  double min_margin = 20.0;  ///< of 255; printed tags in ordinary light reach 40 to 120
  /// Besides where tags were seen last, look at the whole image every so many frames, >= 1. A tag
  /// that comes into view is found at most this many frames later.
  int full_search_interval = 5;
  /// The lens, where it has distortion: tags' edges are straight only once that is taken out.
  /// Without it, a strong lens moves the corners of large tags by some tenths of a pixel.
  std::optional<CameraModel> lens = {};
};

/// Names of the families that TagDetector knows.
[[nodiscard]] const std::vector<std::string>& tag_families();

/// Finds tags of the families given: AprilTag's by libapriltag [Wang & Olson 2016], ArUco's by
/// OpenCV; corners are refined to sub-pixel by fitting the edges' grey values. Between full
/// searches only the surroundings of the tags of the frame before are looked at; where one of them
/// is gone, the whole image is. What is found depends on the images given so far and on nothing
/// else. Not thread-safe: one detector for each stream of images.
class TagDetector {
 public:
  /// An unknown family is an Error. Throws ContractError for an option out of its range.
  [[nodiscard]] static Expected<TagDetector> create(const std::vector<std::string>& families,
                                                    const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Sorted by id, each id at most once.
  [[nodiscard]] std::vector<TagDetection> detect(const GrayImage& image);

 private:
  struct State;
  explicit TagDetector(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
